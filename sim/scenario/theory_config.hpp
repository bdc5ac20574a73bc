// SPDX-License-Identifier: Apache-2.0
// The one-joint arm whose run is compared with its analytic response (sim/theory).
#pragma once

#include <optional>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/design/second_order.hpp"
#include "sim/scenario/commanded_motion.hpp"

namespace fovea::sim {

struct TheoryConfig {
  design::SecondOrder plant;
  double coulomb = 0.0;                   // friction of the plant [N]
  config::MotionLawConfig law;            // pd uses k_p[0], k_v[0]
  std::optional<CommandedJoints> motion;  // none: the goal is 0
  double push = 0.0;                      // constant force from push_s on [N]
  double push_s = 0.0;                    // [s]
  double fit_begin_s = 0.0;
  double fit_end_s = 1e6;
};

}  // namespace fovea::sim
