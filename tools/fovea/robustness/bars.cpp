// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/bars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>

#include "firmware/host/config/input_error.hpp"

namespace fovea::robustness {
namespace {

constexpr double kSigmas = 2.0;  // of a normal number, its stated end

// Quantities whose entries differ one at a time, with the names of these.
struct PartNames {
  const char* quantity;
  std::vector<const char*> names;
};
const std::vector<PartNames>& AllPartNames() {
  static const std::vector<PartNames> kAll{
      {"camera.mount_xyz", {"x", "y", "z"}}, {"camera.mount_turn_deg", {"x", "y", "z"}},
      {"camera.c_px", {"u", "v"}},           {"camera.lens", {"k1", "k2", "p1", "p2", "k3"}},
      {"arm.load_com", {"x", "y", "z"}},     {"arm.base_tilt_deg", {"x", "y"}}};
  return kAll;
}

struct Ends {
  double low = 0.0;
  double high = 0.0;
};

Ends EndsOf(const Uncertainty& one, std::size_t entry) {
  if (one.form == "range" || one.form == "scale_range") {
    const double same = one.form == "range" ? 0.0 : 1.0;
    return {std::min(one.numbers.at(0) - same, 0.0), std::max(one.numbers.at(1) - same, 0.0)};
  }
  const double number = one.numbers.at(one.numbers.size() == 1 ? 0 : entry);
  if (one.form == "sigma" || one.form == "scale_sigma") {
    return {-kSigmas * number, kSigmas * number};
  }
  const double difference = one.form == "scale" ? number - 1.0 : number;
  return {std::min(difference, 0.0), std::max(difference, 0.0)};
}

void CheckForms(const Spec& spec) {
  for (const Uncertainty& one : spec.list) {
    if (one.form.empty()) {
      throw config::InputError(
          fmt::format("{}: truth.{} is a true value, which has no size: use truth.{}.offset", spec.name,
                      one.quantity, one.quantity));
    }
    const auto forms = std::count_if(spec.list.begin(), spec.list.end(), [&](const Uncertainty& other) {
      return other.quantity == one.quantity;
    });
    if (forms > 1) {
      throw config::InputError(
          fmt::format("{}: truth.{} has {} forms: one is allowed when each quantity differs alone", spec.name,
                      one.quantity, forms));
    }
  }
}

}  // namespace

std::vector<Bar> BarsOf(const Spec& spec, const nlohmann::json& drawn) {
  CheckForms(spec);
  std::vector<Bar> bars;
  for (const Uncertainty& one : spec.list) {
    if (!drawn.contains(one.quantity)) {
      throw config::InputError(
          fmt::format("{}: truth.{}.{} makes no difference", spec.name, one.quantity, one.form));
    }
    const nlohmann::json& value = drawn.at(one.quantity);
    Bar bar;
    bar.quantity = one.quantity;
    bar.unit = value.at("unit");
    bar.is_factor = one.form.rfind("scale", 0) == 0;
    bar.entries = value.at("believed").size();
    const auto& all = AllPartNames();
    const auto parts = std::find_if(all.begin(), all.end(), [&](const PartNames& names) {
      return bar.quantity == names.quantity && bar.entries == names.names.size();
    });
    if (parts == all.end() && one.form.find("range") == std::string::npos && one.numbers.size() > 1) {
      throw config::InputError(
          fmt::format("{}: truth.{}.{} has {} numbers: one, for all entries, is allowed "
                      "when each quantity differs alone",
                      spec.name, one.quantity, one.form, one.numbers.size()));
    }
    const std::size_t count = parts == all.end() ? 1 : bar.entries;
    for (std::size_t i = 0; i < count; ++i) {
      if (parts != all.end()) {
        bar.part = parts->names[i];
        bar.only = i;
      }
      const Ends ends = EndsOf(one, i);
      bar.low = ends.low;
      bar.high = ends.high;
      if (bar.low < 0.0 || bar.high > 0.0) {
        bars.push_back(bar);
      }
    }
  }
  return bars;
}

std::string NameOf(const Bar& bar) { return bar.quantity + (bar.part.empty() ? "" : " " + bar.part); }

double EndOf(const Bar& bar, Side side) { return side == Side::kLow ? bar.low : bar.high; }

std::string CaseName(const Bar& bar, Side side, double multiple) {
  return fmt::format("{}{}{}.{}.{:.3g}", bar.quantity, bar.part.empty() ? "" : ".", bar.part,
                     side == Side::kLow ? "low" : "high", multiple);
}

std::string AssignmentOf(const Bar& bar, Side side, double multiple) {
  const double same = bar.is_factor ? 1.0 : 0.0;
  const double other = same + multiple * EndOf(bar, side);
  std::vector<double> numbers(bar.only ? bar.entries : 1, bar.only ? same : other);
  if (bar.only) {
    numbers[*bar.only] = other;
  }
  return TruthAssignment(bar.quantity + (bar.is_factor ? ".scale" : ".offset"), numbers, numbers.size() > 1);
}

Amount AmountOf(const Bar& bar, Side side, double multiple) {
  const double number = multiple * EndOf(bar, side);
  if (bar.is_factor) {
    return {100.0 * number, "%"};
  }
  if (bar.unit == "m") {
    return {1e3 * number, "mm"};
  }
  if (bar.unit == "rad") {
    return {number * 180.0 / std::numbers::pi, "deg"};
  }
  return {number, bar.unit};
}

}  // namespace fovea::robustness
