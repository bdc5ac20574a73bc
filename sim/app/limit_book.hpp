// How much of each limit a run used, and when it used more than there is.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fovea/hal/events.hpp"

namespace fovea::sim {

// Stamps do not go back. One thread uses it.
class LimitBook {
 public:
  // Notes that at `stamp_ns` the share `fraction` of `limit` was used; 1 is all of it, the sign does not
  // count.
  void Note(std::int64_t stamp_ns, hal::Limit limit, double fraction);

  // Adds the largest share of each limit that was ever noted, by its name.
  void AddMost(std::map<std::string, double>& most) const;
  // When a limit was passed; each stamp once, in order.
  [[nodiscard]] const std::vector<std::int64_t>& passed_ns() const { return passed_ns_; }

 private:
  static constexpr double kNever = -1.0;
  std::array<double, hal::kNumLimits> most_ = [] {
    std::array<double, hal::kNumLimits> never;
    never.fill(kNever);
    return never;
  }();
  std::vector<std::int64_t> passed_ns_;
};

}  // namespace fovea::sim
