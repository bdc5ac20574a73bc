// How near a run came to each thing that must hold, and when it went past it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/verdict/summary.hpp"

namespace fovea::sim {

// Stamps do not go back. One thread uses it.
class LimitBook {
 public:
  enum class Kind : std::uint8_t {
    kShare,      // the share of a limit that is used: passed above 1, the sign does not count
    kClearance,  // a distance [m]: passed below 0
    kEvent,      // passed above 0
    kShown,      // as kShare, and never passed: it is reported alone
  };

  // What is noted under the number that it returns.
  std::size_t Add(std::string name, Kind kind);
  // A value that is no number passes.
  void Note(std::int64_t stamp_ns, std::size_t entry, double value);

  // The largest share and the least clearance of each, and in how many ticks it was passed.
  void AddTo(Summary& summary) const;
  // When anything was passed; each stamp once, in order.
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
