// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/compare/compare.hpp"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"

namespace fovea::bench {
namespace {

using nlohmann::json;

struct Entry {
  std::string name;
  double value = 0.0;
  std::string unit;
};

// The figures of a file that have a value, in the order of the file.
std::vector<Entry> Read(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw config::InputError(file + ": cannot be read");
  }
  const json list = json::parse(stream, nullptr, /*allow_exceptions=*/false);
  if (!list.is_array()) {
    throw config::InputError(file + ": must be a list of figures, as --json prints it");
  }
  std::vector<Entry> entries;
  for (const json& figure : list) {
    const bool has_name = figure.is_object() && figure.contains("name") && figure["name"].is_string();
    if (!has_name || !figure.contains("value")) {
      throw config::InputError(file + ": each figure must have a name and a value");
    }
    if (figure["value"].is_number()) {
      entries.push_back({figure["name"], figure["value"], figure.value("unit", "")});
    }
  }
  return entries;
}

}  // namespace

int RunCompare(const CompareArguments& arguments) {
  const std::vector<Entry> before = Read(arguments.old_file);
  const std::vector<Entry> now = Read(arguments.new_file);
  std::map<std::string, double> new_values;
  for (const Entry& entry : now) {
    new_values[entry.name] = entry.value;
  }
  int compared = 0;
  int failed = 0;
  fmt::print("  {:<28}{:>12}{:>12}{:>9}\n", "", "old", "new", "new/old");
  for (const Entry& entry : before) {
    const auto found = new_values.find(entry.name);
    if (found == new_values.end()) {
      fmt::print("  {:<28}{:>12.5g}{:>12}\n", entry.name, entry.value, "-");
      failed += arguments.most > 0.0 ? 1 : 0;
      continue;
    }
    ++compared;
    const double ratio = found->second / entry.value;
    const bool fails = arguments.most > 0.0 && !(found->second <= arguments.most * entry.value);
    failed += fails ? 1 : 0;
    fmt::print("  {:<28}{:>12.5g}{:>12.5g}{:>9.3f} {}{}\n", entry.name, entry.value, found->second, ratio,
               entry.unit, fails ? fmt::format("   more than {:g} times the old", arguments.most) : "");
  }
  if (compared == 0) {
    throw config::InputError(
        fmt::format("{} and {} have no figure in common", arguments.old_file, arguments.new_file));
  }
  return failed > 0 ? config::kGoalMissed : config::kDone;
}

}  // namespace fovea::bench
