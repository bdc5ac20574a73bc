// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>

#include <fstream>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {
namespace {

std::vector<double> ToNumbers(const toml::array& array, const std::string& what) {
  std::vector<double> numbers;
  for (const toml::node& element : array) {
    if (element.is_table()) {
      throw InputError(what + ": a list of tables is not allowed here; write a section [name] once");
    }
    const auto number = element.value<double>();
    if (!number || !element.is_number()) {
      throw InputError(what + ": every entry must be a number");
    }
    numbers.push_back(*number);
  }
  return numbers;
}

Value ToValue(const toml::node& node, const std::string& what) {
  if (const auto flag = node.as_boolean()) {
    return flag->get();
  }
  if (const auto integer = node.as_integer()) {
    return integer->get();
  }
  if (const auto number = node.as_floating_point()) {
    return number->get();
  }
  if (const auto text = node.as_string()) {
    return text->get();
  }
  if (const auto array = node.as_array()) {
    return ToNumbers(*array, what);
  }
  throw InputError(what + ": dates and times are not allowed here");
}

void Flatten(const toml::table& table, const std::string& prefix, const std::string& file,
             std::vector<Setting>& settings) {
  for (const auto& [name, node] : table) {
    const std::string key =
        prefix.empty() ? std::string(name.str()) : fmt::format("{}.{}", prefix, name.str());
    const std::string where = fmt::format("{}:{}", file, node.source().begin.line);
    if (const toml::table* inner = node.as_table()) {
      if (inner->empty() && !prefix.empty()) {  // a section without keys is no mistake
        throw InputError(
            fmt::format("{}: {} is an empty table; at least one key in it is needed", where, key));
      }
      Flatten(*inner, key, file, settings);
      continue;
    }
    settings.push_back({key, ToValue(node, fmt::format("{}: {}", where, key)), where});
  }
}

// The parser recurses once per level of a dotted key (a.a.a ...). A line limit bounds that depth.
constexpr std::size_t kLongestLine = 10'000;  // bytes

void CheckLine(const std::string& line, const std::string& where) {
  if (line.size() > kLongestLine) {
    throw InputError(
        fmt::format("{}: a line of {} bytes; at most {} are allowed", where, line.size(), kLongestLine));
  }
}

// The file's text. InputError: a line that is too long.
std::string TextOf(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    CheckLine(line, fmt::format("{}:{}", path.string(), number));
    text += line;
    text += '\n';
  }
  if (stream.bad() || !stream.eof()) {
    throw InputError(path.string() + ": cannot be read");
  }
  return text;
}

}  // namespace

std::vector<Setting> ReadTomlFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(path.string() + ": is a folder; a TOML file is allowed");
  }
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw InputError(path.string() + ": no such file");
  }
  std::vector<Setting> settings;
  try {
    const toml::table table = toml::parse(TextOf(path), path.string());
    Flatten(table, "", path.string(), settings);
  } catch (const toml::parse_error& error) {
    throw InputError(
        fmt::format("{}:{}: not TOML: {}", path.string(), error.source().begin.line, error.description()));
  }
  return settings;
}

Setting ParseAssignment(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos) {
    throw InputError("--set " + text + ": expected key=value, as in --set servo.lambda=3");
  }
  const std::string key = text.substr(0, equals);
  const std::string value = text.substr(equals + 1);
  CheckLine(value, "--set " + key);
  try {
    const toml::table table = toml::parse("value = " + value);
    if (table.size() != 1) {
      throw InputError("--set " + key + ": more than one value");
    }
    if (table.get("value")->is_table()) {
      throw InputError(
          fmt::format("--set {0}: a table is not allowed here; give each of its keys, as in "
                      "--set {0}.NAME=VALUE",
                      key));
    }
    return {key, ToValue(*table.get("value"), "--set " + key), "--set"};
  } catch (const toml::parse_error&) {
    // Bare text needs no quotes on a command line; anything with TOML's own characters must be TOML.
    if (value.empty() || value.find_first_of("\"'[]{}\n") != std::string::npos) {
      throw InputError("--set " + text + ": the value is not TOML");
    }
    return {key, value, "--set"};
  }
}

std::string ToText(const Value& value) {
  struct Printer {
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(std::int64_t integer) const { return fmt::format("{}", integer); }
    std::string operator()(double number) const { return fmt::format("{}", number); }
    std::string operator()(const std::string& text) const {
      std::string escaped;
      for (const char c : text) {
        escaped += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
      }
      return fmt::format("\"{}\"", escaped);
    }
    std::string operator()(const std::vector<double>& numbers) const {
      return fmt::format("[{}]", fmt::join(numbers, ", "));
    }
  };
  return std::visit(Printer{}, value);
}

}  // namespace fovea::config
