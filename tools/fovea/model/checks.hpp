// SPDX-License-Identifier: Apache-2.0
// Checks an arm's model against laws that hold for any rigid-body model. Each residual comes from a formula
// that the model itself does not use.
#pragma once

#include <string>
#include <vector>

#include "firmware/core/model/arm_model.hpp"

namespace fovea {

struct ModelCheck {
  std::string what;
  double value = 0.0;  // the worst value over all states
  std::string unit;
  double bound = 0.0;
  bool at_least = false;  // true: good when value >= bound; false: when value <= bound
  [[nodiscard]] bool Good() const { return at_least ? value >= bound : value <= bound; }
};

// Checks `states` random states within the joints' ranges, the same ones in each call.
std::vector<ModelCheck> CheckModel(const model::ArmModel& arm, int states);

}  // namespace fovea
