// How much of each limit a run used, and when it used more than there is.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fovea::sim {

// Stamps do not go back. One thread uses it.
class LimitBook {
 public:
  // Notes that at `stamp_ns` the share `fraction` of `limit` was used; 1 is all of it.
  void Note(std::int64_t stamp_ns, const char* limit, double fraction);

  // The largest share of each limit so far.
  [[nodiscard]] const std::map<std::string, double>& most() const { return most_; }
  // When a limit was passed; each stamp once, in order.
  [[nodiscard]] const std::vector<std::int64_t>& passed_ns() const { return passed_ns_; }

 private:
  std::map<std::string, double> most_;
  std::vector<std::int64_t> passed_ns_;
};

}  // namespace fovea::sim
