// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/limit_book.hpp"

#include <cmath>
#include <utility>

namespace fovea::sim {
namespace {

constexpr double kTolerance = 1e-9;  // for rounding

// A measure of a value: the larger, the worse. Allowed is its largest value without a violation.
double Badness(LimitBook::Kind kind, double value) {
  return kind == LimitBook::Kind::kClearance ? -value : std::fabs(value);
}
double Allowed(LimitBook::Kind kind) {
  switch (kind) {
    case LimitBook::Kind::kShare: return 1.0 + kTolerance;
    case LimitBook::Kind::kShown: return HUGE_VAL;
    case LimitBook::Kind::kClearance:
    case LimitBook::Kind::kEvent: break;
  }
  return kTolerance;
}

}  // namespace

std::size_t LimitBook::Add(std::string name, Kind kind) {
  entries_.push_back({std::move(name), kind});
  return entries_.size() - 1;
}

void LimitBook::Note(std::int64_t stamp_ns, std::size_t entry, double value) {
  Entry& e = entries_[entry];
  const double badness = Badness(e.kind, value);
  if (!e.noted || badness > Badness(e.kind, e.worst)) {
    e.worst = e.kind == Kind::kClearance ? value : std::fabs(value);
    e.noted = true;
  }
  if (badness <= Allowed(e.kind) || e.kind == Kind::kShown) {
    return;
  }
  if (e.passed_ticks == 0 || e.last_passed_ns != stamp_ns) {
    ++e.passed_ticks;
    e.last_passed_ns = stamp_ns;
  }
  if (passed_ns_.empty() || passed_ns_.back() != stamp_ns) {
    passed_ns_.push_back(stamp_ns);
  }
}

void LimitBook::AddTo(Summary& summary) const {
  for (const Entry& e : entries_) {
    if (e.noted && e.kind == Kind::kShare) {
      summary.limits[e.name] = e.worst;
    } else if (e.noted && e.kind == Kind::kClearance) {
      summary.clearances_m[e.name] = e.worst;
    } else if (e.noted && e.kind == Kind::kShown) {
      summary.unjudged[e.name] = e.worst;
    }
    if (e.passed_ticks > 0) {
      summary.violations[e.name] += e.passed_ticks;
    }
  }
}

}  // namespace fovea::sim
