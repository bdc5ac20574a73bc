// Checks of an arm's model against what must hold for any rigid body: each residual comes from a formula that
// the model itself does not use.
#pragma once

#include <string>
#include <vector>

#include "firmware/core/model/arm_model.hpp"

namespace fovea {

struct ModelCheck {
  std::string what;
  double value = 0.0;  // the worst over all states
  std::string unit;
  double bound = 0.0;
  bool at_least = false;  // value >= bound is good, instead of <=
  [[nodiscard]] bool Good() const { return at_least ? value >= bound : value <= bound; }
};

// Over `states` random ones within the joints' ranges, always the same.
std::vector<ModelCheck> CheckModel(const model::ArmModel& arm, int states);

}  // namespace fovea
