// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/deviation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/host/config/input_error.hpp"
#include "sim/faults/chance.hpp"

namespace fovea::sim {
namespace {

constexpr double kMostSigmas = 3.0;

// Entry `i` of a list, which may have one entry for all.
double At(const std::vector<double>& list, std::size_t i) { return list.size() == 1 ? list[0] : list[i]; }

void Scale(double low, double high, Span& span) {
  const auto [least, most] =
      std::minmax({span.low * low, span.low * high, span.high * low, span.high * high});
  span = {least, most};
}

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : seed_(seed) {}

  double Uniform(const std::vector<double>& range) {
    return range[0] + (range[1] - range[0]) * Chance(seed_, event_++);
  }
  double Normal() {
    for (;;) {
      const double normal = NormalChance(seed_, event_);
      event_ += 2;
      if (std::fabs(normal) <= kMostSigmas) {
        return normal;
      }
    }
  }

 private:
  const std::uint64_t seed_;
  std::uint64_t event_ = 0;
};

}  // namespace

bool Deviation::IsAny() const {
  return !(value.empty() && scale.empty() && scale_sigma.empty() && scale_range.empty() && offset.empty() &&
           sigma.empty() && range.empty());
}

void CheckForms(const Deviation& d, const std::string& key, std::size_t size) {
  struct List {
    const char* form;
    const std::vector<double>& numbers;
  };
  for (const List& list : {List{"", d.value},
                           {".scale", d.scale},
                           {".scale_sigma", d.scale_sigma},
                           {".offset", d.offset},
                           {".sigma", d.sigma}}) {
    const std::size_t entries = list.numbers.size();
    if (entries > 1 && entries != size) {
      throw config::InputError(
          fmt::format("{}{} has {} entries: 1 or {} are allowed", key, list.form, entries, size));
    }
  }
  for (const List& list : {List{".scale_range", d.scale_range}, {".range", d.range}}) {
    if (!list.numbers.empty() && list.numbers[0] > list.numbers[1]) {
      throw config::InputError(
          fmt::format("{}{} = [{:g}, {:g}] is not allowed: the smaller number comes first", key, list.form,
                      list.numbers[0], list.numbers[1]));
    }
  }
  Deviation others = d;
  others.value.clear();
  if (!d.value.empty() && others.IsAny()) {
    throw config::InputError(fmt::format(
        "{} is not allowed as a value and as a difference at once: use {}.offset for the first", key, key));
  }
}

std::vector<Span> SpansOf(const Deviation& d, const std::vector<double>& believed) {
  std::vector<Span> spans;
  for (std::size_t i = 0; i < believed.size(); ++i) {
    const double start = d.value.empty() ? believed[i] : At(d.value, i);
    Span span{start, start};
    if (!d.scale.empty()) {
      Scale(At(d.scale, i), At(d.scale, i), span);
    }
    if (!d.scale_sigma.empty()) {
      const double most = kMostSigmas * At(d.scale_sigma, i);
      Scale(1.0 - most, 1.0 + most, span);
    }
    if (!d.scale_range.empty()) {
      Scale(d.scale_range[0], d.scale_range[1], span);
    }
    const double offset = d.offset.empty() ? 0.0 : At(d.offset, i);
    const double most = d.sigma.empty() ? 0.0 : kMostSigmas * At(d.sigma, i);
    const Span added = d.range.empty() ? Span{} : Span{d.range[0], d.range[1]};
    spans.push_back({span.low + offset - most + added.low, span.high + offset + most + added.high});
  }
  return spans;
}

std::vector<double> Draw(const Deviation& d, const std::vector<double>& believed, std::uint64_t seed) {
  Dice dice(seed);
  std::vector<double> values = believed;
  for (std::size_t i = 0; i < values.size(); ++i) {
    double& value = values[i];
    value = d.value.empty() ? value : At(d.value, i);
    value *= d.scale.empty() ? 1.0 : At(d.scale, i);
    value *= d.scale_sigma.empty() ? 1.0 : 1.0 + At(d.scale_sigma, i) * dice.Normal();
    value *= d.scale_range.empty() ? 1.0 : dice.Uniform(d.scale_range);
    value += d.offset.empty() ? 0.0 : At(d.offset, i);
    value += d.sigma.empty() ? 0.0 : At(d.sigma, i) * dice.Normal();
    value += d.range.empty() ? 0.0 : dice.Uniform(d.range);
  }
  return values;
}

}  // namespace fovea::sim
