#include "sim/app/limit_book.hpp"

#include <algorithm>

namespace fovea::sim {
namespace {

constexpr double kTolerance = 1e-9;  // rounding passes no limit

}  // namespace

void LimitBook::Note(std::int64_t stamp_ns, const char* limit, double fraction) {
  double& most = most_[limit];
  most = std::max(most, fraction);
  if (fraction > 1.0 + kTolerance && (passed_ns_.empty() || passed_ns_.back() != stamp_ns)) {
    passed_ns_.push_back(stamp_ns);
  }
}

}  // namespace fovea::sim
