// SPDX-License-Identifier: Apache-2.0
// Names and units of the entries of the error e = s_star - s.
#pragma once

#include <string>
#include <vector>

#include "fovea/run.pb.h"

namespace fovea::report {

struct ErrorComponent {
  std::string name;
  std::string unit;  // "1": no unit
};

// One for each entry of s of the feature in `setup`, then the three of a held orientation, which are present
// in s only if the servo holds it (features/hold_orientation.hpp).
std::vector<ErrorComponent> ErrorComponentsOf(const log::Setup& setup);

}  // namespace fovea::report
