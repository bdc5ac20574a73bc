// The version of summary.json, of the simulator and of the hardware program alike.
#pragma once

namespace fovea {

// It rises when a field is renamed, goes, or comes to mean something else; a field more needs no new one.
inline constexpr int kSummaryFormat = 1;

}  // namespace fovea
