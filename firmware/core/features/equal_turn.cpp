// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/equal_turn.hpp"

#include <array>
#include <cmath>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/core/model/math.hpp"

namespace fovea::features {

model::Mat3 EqualTurn(int turn, int turns) noexcept {
  model::SinCosResult by{0.0, 1.0};
  if (4 * turn % turns == 0) {
    constexpr std::array<double, 4> kCos{1.0, 0.0, -1.0, 0.0};
    const int quarters = 4 * turn / turns;
    by.cos = kCos[static_cast<std::size_t>(quarters & 3)];
    by.sin = kCos[static_cast<std::size_t>((quarters + 3) & 3)];
  } else {
    by = model::SinCos(2.0 * model::kPi * turn / turns);
  }
  model::Mat3 R;
  R << by.cos, -by.sin, 0.0, by.sin, by.cos, 0.0, 0.0, 0.0, 1.0;
  return R;
}

int NearestTurn(const TargetFeature& feature, const model::Mat3& R_CO) noexcept {
  const int turns = TraitsOf(feature.target).turns;
  int nearest = 0;
  double most = -HUGE_VAL;
  for (int turn = 0; turn < turns; ++turn) {
    const double likeness = feature.R_CO_star.cwiseProduct(R_CO * EqualTurn(turn, turns)).sum();
    if (likeness > most) {
      most = likeness;
      nearest = turn;
    }
  }
  return nearest;
}

}  // namespace fovea::features
