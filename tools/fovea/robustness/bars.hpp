// SPDX-License-Identifier: Apache-2.0
// The single deviations of a specification: one part of one quantity, to one side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/fovea/robustness/spec.hpp"

namespace fovea::robustness {

enum class Side : std::uint8_t { kLow, kHigh };
inline constexpr Side kSides[]{Side::kLow, Side::kHigh};

// One bar of a tornado chart. Of a place or a turn, each axis is a part of its own. The joints differ all
// together, by factors or amounts of the same sign.
struct Bar {
  std::string quantity;             // "camera.mount_xyz"
  std::string part;                 // "x"; "" for all entries
  std::string unit;                 // of the quantity
  bool is_factor = false;           // the ends are of a factor, as distances from 1
  std::size_t entries = 1;          // of the quantity
  std::optional<std::size_t> only;  // the entry that differs; none: all
  double low = 0.0;                 // stated ends of the difference, at or below 0
  double high = 0.0;                // at or above 0
};

// The bars of `spec`. `drawn`: what a run draws with it, as "truth" in a summary, for the number of entries
// and the units. The ends of a sigma are at two standard deviations, those of a fixed difference at 0 and
// itself. InputError: a quantity has several forms, a true value given by itself, or no difference.
std::vector<Bar> BarsOf(const Spec& spec, const nlohmann::json& drawn);

// "camera.mount_xyz x"
std::string NameOf(const Bar& bar);
// Its stated end to this side; 0 if it does not differ to this side.
double EndOf(const Bar& bar, Side side);
// Name of the case in which the bar differs to `side` by `multiple` of its stated end; fit for a file.
std::string CaseName(const Bar& bar, Side side, double multiple);
// The same as a value of fovea-sim's --set.
std::string AssignmentOf(const Bar& bar, Side side, double multiple);

// A difference as people read it: "mm", "deg", "%", ... The number is in this unit.
struct Amount {
  double number = 0.0;
  std::string unit;
};
Amount AmountOf(const Bar& bar, Side side, double multiple);

}  // namespace fovea::robustness
