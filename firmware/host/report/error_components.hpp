// What the entries of the error e = s_star - s are called, and their units.
#pragma once

#include <string>
#include <vector>

#include "fovea/run.pb.h"

namespace fovea::report {

struct ErrorComponent {
  std::string name;
  std::string unit;  // "1": it has none
};

// Of the feature in `setup`, as many as its s has entries; and the three of a held orientation, stacked below
// where the servo holds it (features/hold_orientation.hpp).
std::vector<ErrorComponent> ErrorComponentsOf(const log::Setup& setup);

}  // namespace fovea::report
