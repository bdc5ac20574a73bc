#include "sim/app/limit_book.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::sim {
namespace {

constexpr double kTolerance = 1e-9;  // rounding passes no limit

}  // namespace

void LimitBook::Note(std::int64_t stamp_ns, hal::Limit limit, double fraction) {
  const double used = std::fabs(fraction);
  double& most = most_[static_cast<std::size_t>(limit)];
  most = std::max(most, used);
  if (used > 1.0 + kTolerance && (passed_ns_.empty() || passed_ns_.back() != stamp_ns)) {
    passed_ns_.push_back(stamp_ns);
  }
}

void LimitBook::AddMost(std::map<std::string, double>& most) const {
  for (int i = 0; i < hal::kNumLimits; ++i) {
    if (const double used = most_[static_cast<std::size_t>(i)]; used != kNever) {
      most[hal::Name(static_cast<hal::Limit>(i))] = used;
    }
  }
}

}  // namespace fovea::sim
