// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/spec.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/host/config/settings.hpp"
#include "firmware/host/config/share_folder.hpp"

namespace fovea::robustness {
namespace {

namespace fs = std::filesystem;
using config::InputError;

const std::string kSection = "truth.";
constexpr std::array<const char*, 6> kForms{"scale",  "scale_sigma", "scale_range",
                                            "offset", "sigma",       "range"};

fs::path ShippedFolder() { return config::ShareFolder() / "truth"; }

fs::path FindSpec(const std::string& name_or_path) {
  if (fs::path(name_or_path).extension() == ".toml") {
    return name_or_path;
  }
  const fs::path shipped = ShippedFolder() / (name_or_path + ".toml");
  if (!fs::is_regular_file(shipped)) {
    const std::vector<std::string> names = ShippedSpecs();
    throw InputError(fmt::format("--truth {}: unknown{}; shipped are {} (or give the path of a .toml)",
                                 name_or_path, config::DidYouMean(name_or_path, names),
                                 fmt::join(names, ", ")));
  }
  return shipped;
}

std::optional<std::vector<double>> Numbers(const config::Value& value) {
  if (const auto* number = std::get_if<double>(&value)) {
    return std::vector{*number};
  }
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return std::vector{static_cast<double>(*integer)};
  }
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    return *list;
  }
  return std::nullopt;
}

void Add(const config::Setting& setting, Spec& spec) {
  if (!IsTruth(setting.key)) {
    throw InputError(
        fmt::format("{}: {} is not allowed: only keys of [truth] are", setting.where, setting.key));
  }
  const std::optional<std::vector<double>> numbers = Numbers(setting.value);
  if (!numbers) {
    throw InputError(fmt::format("{}: {} = {} is not allowed: a number or a list of numbers is",
                                 setting.where, setting.key, config::ToText(setting.value)));
  }
  Uncertainty one{setting.key.substr(kSection.size()), "", *numbers,
                  std::holds_alternative<std::vector<double>>(setting.value)};
  const auto dot = one.quantity.rfind('.');
  const std::string last = dot == std::string::npos ? "" : one.quantity.substr(dot + 1);
  if (std::find(kForms.begin(), kForms.end(), last) != kForms.end()) {
    one.form = last;
    one.quantity.resize(dot);
  }
  const auto same = std::find_if(spec.list.begin(), spec.list.end(), [&](const Uncertainty& other) {
    return other.quantity == one.quantity && other.form == one.form;
  });
  if (same == spec.list.end()) {
    spec.list.push_back(std::move(one));
  } else {
    *same = std::move(one);
  }
}

}  // namespace

bool IsTruth(const std::string& assignment) { return assignment.rfind(kSection, 0) == 0; }

std::vector<std::string> ShippedSpecs() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(ShippedFolder(), ignored)) {
    if (entry.path().extension() == ".toml") {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

Spec LoadSpec(const std::string& name_or_path, const std::vector<std::string>& assignments) {
  Spec spec{name_or_path.empty() ? "--set" : name_or_path, {}};
  if (!name_or_path.empty()) {
    const fs::path file = FindSpec(name_or_path);
    for (const config::Setting& setting : config::ReadTomlFile(file)) {
      Add(setting, spec);
    }
    if (spec.list.empty()) {
      throw InputError(fmt::format("{}: has no key of [truth]", file.string()));
    }
  }
  for (const std::string& assignment : assignments) {
    Add(config::ParseAssignment(assignment), spec);
  }
  if (spec.list.empty()) {
    throw InputError("no uncertainty is given: use --truth, or --set with keys of [truth]");
  }
  return spec;
}

std::string TruthAssignment(const std::string& key, const std::vector<double>& numbers, bool as_list) {
  return as_list ? fmt::format("{}{}=[{:.15g}]", kSection, key, fmt::join(numbers, ","))
                 : fmt::format("{}{}={:.15g}", kSection, key, numbers[0]);
}

std::vector<std::string> Scaled(const Spec& spec, double size) {
  std::vector<std::string> assignments;
  if (size == 0.0) {
    return assignments;
  }
  for (const Uncertainty& one : spec.list) {
    std::vector<double> numbers = one.numbers;
    if (one.form.empty() && size != 1.0) {
      throw InputError(fmt::format("{}: truth.{} is a true value, which has no size: use truth.{}.offset",
                                   spec.name, one.quantity, one.quantity));
    }
    const bool is_factor = one.form == "scale" || one.form == "scale_range";
    for (double& number : numbers) {
      number = is_factor ? 1.0 + size * (number - 1.0) : size * number;
    }
    assignments.push_back(
        TruthAssignment(one.quantity + (one.form.empty() ? "" : "." + one.form), numbers, one.is_list));
  }
  return assignments;
}

}  // namespace fovea::robustness
