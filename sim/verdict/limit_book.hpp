// SPDX-License-Identifier: Apache-2.0
// Records for each condition of a run how close it came to its bound, and when it exceeded it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/verdict/summary.hpp"

namespace fovea::sim {

// Stamps must not decrease. Only one thread may use it.
class LimitBook {
 public:
  enum class Kind : std::uint8_t {
    kShare,      // used share of a limit, by absolute value: a violation above 1
    kClearance,  // a distance [m]: a violation below 0
    kEvent,      // a violation above 0
    kShown,      // as kShare, but only reported: never a violation
  };

  // Adds an entry. Returns its number for Note.
  std::size_t Add(std::string name, Kind kind);
  // Records a value. NaN is a violation.
  void Note(std::int64_t stamp_ns, std::size_t entry, double value);

  // Adds the largest share or least clearance of each entry, and its ticks with a violation.
  void AddTo(Summary& summary) const;
  // Stamps with any violation; each stamp once, in order.
  [[nodiscard]] const std::vector<std::int64_t>& passed_ns() const { return passed_ns_; }

 private:
  struct Entry {
    std::string name;
    Kind kind = Kind::kShare;
    bool noted = false;
    double worst = 0.0;
    std::uint64_t passed_ticks = 0;
    std::int64_t last_passed_ns = 0;
  };
  std::vector<Entry> entries_;
  std::vector<std::int64_t> passed_ns_;
};

}  // namespace fovea::sim
