// SPDX-License-Identifier: Apache-2.0
// The blurred step of an edge.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fovea::vision {

// Table of the step 1 - Phi(x) and its density, for speed; `x` in standard deviations of the blur.
class StepTable {
 public:
  StepTable() {
    for (int i = 0; i < kSize; ++i) {
      const double x = -kReach + 2.0 * kReach * i / (kSize - 1);
      step_[static_cast<std::size_t>(i)] = 0.5 * std::erfc(x / std::sqrt(2.0));
      density_[static_cast<std::size_t>(i)] = 0.3989422804014327 * std::exp(-0.5 * x * x);
    }
  }
  void At(double x, double& step, double& density) const {
    const double place = std::clamp((x + kReach) * ((kSize - 1) / (2.0 * kReach)), 0.0, kSize - 1.001);
    const auto i = static_cast<std::size_t>(place);
    const double a = place - static_cast<double>(i);
    step = step_[i] + a * (step_[i + 1] - step_[i]);
    density = density_[i] + a * (density_[i + 1] - density_[i]);
  }

 private:
  static constexpr double kReach = 5.0;
  static constexpr int kSize = 1001;
  std::array<double, kSize> step_;
  std::array<double, kSize> density_;
};

}  // namespace fovea::vision
