// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/bisection.hpp"

#include <cmath>

namespace fovea::robustness {

const std::vector<double>& MarginMultiples() {
  static const std::vector<double> kMultiples = [] {
    constexpr int kLastPower = 10;
    std::vector<double> multiples;
    for (int power = -static_cast<int>(kStatedMultiple); power <= kLastPower; ++power) {
      multiples.push_back(std::exp2(0.5 * power));
    }
    return multiples;
  }();
  return kMultiples;
}

std::optional<std::size_t> Bisection::Next() const {
  if (number_borne_ == least_not_) {
    return std::nullopt;
  }
  return is_first_ ? first_ : number_borne_ + (least_not_ - number_borne_) / 2;
}

void Bisection::Note(bool is_borne) {
  const std::optional<std::size_t> tried = Next();
  if (!tried) {
    return;
  }
  is_first_ = false;
  if (is_borne) {
    number_borne_ = *tried + 1;
  } else {
    least_not_ = *tried;
  }
}

std::optional<std::size_t> Bisection::borne() const {
  return number_borne_ > 0 ? std::optional(number_borne_ - 1) : std::nullopt;
}

std::optional<std::size_t> Bisection::not_borne() const {
  return least_not_ < sizes_ ? std::optional(least_not_) : std::nullopt;
}

}  // namespace fovea::robustness
