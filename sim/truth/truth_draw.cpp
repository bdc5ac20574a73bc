// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/truth_draw.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/host/config/input_error.hpp"
#include "sim/camera/mix_bits.hpp"

namespace fovea::sim {
namespace {

bool OnlyScales(const Deviation& d) {
  return d.value.empty() && d.offset.empty() && d.sigma.empty() && d.range.empty();
}

}  // namespace

std::vector<double> TruthDraw::Get(Quantity quantity, const std::vector<double>& believed) {
  const QuantityInfo& info = InfoOf(quantity);
  return Get(quantity, believed, std::vector<Span>(believed.size(), {info.low, info.high}));
}

std::vector<double> TruthDraw::Get(Quantity quantity, const std::vector<double>& believed,
                                   const std::vector<Span>& allowed) {
  const Deviation& deviation = settings_.of.at(static_cast<std::size_t>(quantity));
  if (!deviation.IsAny()) {
    return believed;
  }
  const QuantityInfo& info = InfoOf(quantity);
  const std::string key = std::string("truth.") + info.key;
  CheckForms(deviation, key, believed.size());
  if (OnlyScales(deviation) &&
      std::all_of(believed.begin(), believed.end(), [](double v) { return v == 0.0; })) {
    throw config::InputError(fmt::format(
        "{} has no effect: the servo believes 0, and a factor leaves that; use {}.offset or .sigma", key,
        key));
  }
  const std::string unit = info.unit[0] == '\0' ? "" : std::string(" ") + info.unit;
  const std::vector<Span> spans = SpansOf(deviation, believed);
  for (std::size_t i = 0; i < spans.size(); ++i) {
    if (!(spans[i].low >= allowed[i].low && spans[i].high <= allowed[i].high)) {
      throw config::InputError(fmt::format(
          "{} is not allowed: entry {} could be from {:.6g} to {:.6g}{}; allowed is {:g} to {:g}{}", key,
          i + 1, spans[i].low, spans[i].high, unit, allowed[i].low, allowed[i].high, unit));
    }
  }
  const std::uint64_t seed = MixBits(seed_ + static_cast<std::uint64_t>(quantity));
  std::vector<double> actual = Draw(deviation, believed, seed);
  if (actual != believed) {
    differing_.push_back({quantity, believed, actual});
  }
  return actual;
}

void TruthDraw::Refuse(Quantity quantity, const std::string& reason) const {
  if (settings_.of.at(static_cast<std::size_t>(quantity)).IsAny()) {
    throw config::InputError(fmt::format("truth.{} has no effect: {}", InfoOf(quantity).key, reason));
  }
}

}  // namespace fovea::sim
