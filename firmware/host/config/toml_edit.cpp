// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/toml_edit.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>

#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/settings.hpp"

namespace fovea::config {
namespace {

namespace fs = std::filesystem;

toml::table Parse(const std::string& text) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("line {}: not TOML: {}", error.source().begin.line, error.description()));
  }
}

// Byte offset of a place in `text`. TOML's columns count characters; one may take several bytes in UTF-8.
std::size_t OffsetOf(const std::string& text, const toml::source_position& place) {
  std::size_t offset = 0;
  for (toml::source_index line = 1; line < place.line; ++line) {
    offset = text.find('\n', offset) + 1;
  }
  for (toml::source_index column = 1; column < place.column; ++column) {
    ++offset;
    while (offset < text.size() && (static_cast<unsigned char>(text[offset]) & 0xC0U) == 0x80U) {
      ++offset;
    }
  }
  return offset;
}

// Where the text of table [section] begins: the line after its header.
std::size_t AfterHeader(const std::string& text, const toml::table& table, const std::string& section) {
  const std::size_t begin = OffsetOf(text, table.source().begin);
  if (begin >= text.size() || text[begin] != '[' || (begin > 0 && text[begin - 1] != '\n')) {
    throw InputError(fmt::format("{} is not written as a section [{}]: change it by hand", section, section));
  }
  const std::size_t end = text.find('\n', begin);
  return end == std::string::npos ? text.size() : end + 1;
}

std::string LineOf(const NewValue& value) { return fmt::format("{} = {}\n", value.key, value.value); }

// `text` has the table [section].
std::string WithValue(const std::string& text, const std::string& section, const NewValue& value) {
  const toml::table all = Parse(text);
  const toml::node* node = all.get(section);  // not null
  const toml::table* table = node->as_table();
  if (table == nullptr) {
    throw InputError(fmt::format("{} is a value, not a section", section));
  }
  const std::size_t start = AfterHeader(text, *table, section);
  const toml::node* old = table->get(value.key);
  if (old == nullptr) {
    const std::string before = text.substr(0, start);
    return before + (before.empty() || before.back() == '\n' ? "" : "\n") + LineOf(value) +
           text.substr(start);
  }
  const std::size_t from = OffsetOf(text, old->source().begin);
  const std::size_t to = OffsetOf(text, old->source().end);
  // A comment after a value describes that value: it goes too.
  std::size_t rest = text.find('\n', to);
  rest = rest == std::string::npos ? text.size() : rest;
  return text.substr(0, from) + value.value + text.substr(rest);
}

// Every value by its key, as TOML prints it.
std::map<std::string, std::string> ValuesOf(const toml::table& table, const std::string& prefix = "") {
  std::map<std::string, std::string> values;
  for (const auto& [name, node] : table) {
    const std::string key = prefix + std::string(name.str());
    if (const toml::table* inner = node.as_table()) {
      values.merge(ValuesOf(*inner, key + "."));
    } else {
      std::ostringstream text;
      node.visit([&text](const auto& of) { text << of; });
      values[key] = text.str();
    }
  }
  return values;
}

}  // namespace

std::string SectionText(const std::string& section, const std::vector<NewValue>& values) {
  std::string text = fmt::format("[{}]\n", section);
  for (const NewValue& value : values) {
    text += LineOf(value);
  }
  return text;
}

std::string WithValues(const std::string& text, const std::string& section,
                       const std::vector<NewValue>& values) {
  std::string changed = text;
  if (Parse(text).contains(section)) {
    // In reverse: each new value is inserted before those added earlier.
    for (auto value = values.rbegin(); value != values.rend(); ++value) {
      changed = WithValue(changed, section, *value);
    }
  } else {
    changed += text.empty() ? "" : text.back() == '\n' ? "\n" : "\n\n";
    changed += SectionText(section, values);
  }
  // The result must hold the new values and otherwise the old ones.
  std::map<std::string, std::string> wanted = ValuesOf(Parse(text));
  for (const NewValue& value : values) {
    wanted[section + "." + value.key] = ValuesOf(Parse("value = " + value.value)).at("value");
  }
  if (ValuesOf(Parse(changed)) != wanted) {
    throw InputError(
        fmt::format("[{}] is written in a form that cannot be edited here: change it by hand", section));
  }
  return changed;
}

void WriteValues(const fs::path& file, const std::string& section, const std::vector<NewValue>& values) {
  (void)ReadTomlFile(file);  // InputError for a missing file or invalid TOML
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::string changed;
  try {
    changed = WithValues(text, section, values);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file.string(), error.what()));
  }
  const fs::path target = fs::canonical(file);
  fs::path beside = target;
  beside += ".new";
  std::ofstream out(beside, std::ios::binary | std::ios::trunc);
  out << changed;
  out.close();
  std::error_code failed;
  if (out) {
    fs::permissions(beside, fs::status(target).permissions(), failed);
    fs::rename(beside, target, failed);
  }
  if (!out || failed) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    throw InputError(file.string() + ": cannot be written");
  }
}

}  // namespace fovea::config
