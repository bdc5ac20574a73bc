// SPDX-License-Identifier: Apache-2.0
// A root of a continuous function between two places where its signs differ, in a bounded number of steps.
//
// Chandrupatla's rule (A new hybrid quadratic/bisection algorithm, 1997): inverse quadratic interpolation
// through the last three places if that can be trusted, else halving. The roots of this folder need about ten
// steps, to the last bits of a double.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace fovea::trajectory {

inline constexpr int kRootSteps = 100;

// `f_low` and `f_high` are the values at the ends. If their signs do not differ, which only rounding causes,
// returns the end nearer to a root. After kRootSteps, returns the best place so far. Real-time: yes.
template <typename Function>
[[nodiscard]] double BracketedRoot(Function f, double low, double f_low, double high,
                                   double f_high) noexcept {
  struct Place {
    double x;
    double f;
  };
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  Place newest{low, f_low};
  Place other{high, f_high};  // across the root
  double share = 0.5;         // next place, from `newest` (0) to `other` (1)
  if ((f_low < 0.0) == (f_high < 0.0)) {
    return std::fabs(f_low) < std::fabs(f_high) ? low : high;
  }
  for (int step = 0; step < kRootSteps; ++step) {
    const Place& best = std::fabs(newest.f) < std::fabs(other.f) ? newest : other;
    const double width = std::fabs(other.x - newest.x);
    const double share_min = kEpsilon * std::fabs(best.x) / width;
    if (best.f == 0.0 || !(share_min < 0.5)) {
      return best.x;
    }
    share = std::max(share_min, std::min(1.0 - share_min, share));
    Place next{newest.x + share * (other.x - newest.x), 0.0};
    next.f = f(next.x);
    // The place that left the bracket is still used for the interpolation.
    Place third = newest;
    if ((next.f < 0.0) != (newest.f < 0.0)) {
      third = other;
      other = newest;
    }
    newest = next;
    share = 0.5;
    const double xi = (newest.x - other.x) / (third.x - other.x);
    const double phi = (newest.f - other.f) / (third.f - other.f);
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
      share = newest.f / (other.f - newest.f) * third.f / (other.f - third.f) +
              (third.x - newest.x) / (other.x - newest.x) * newest.f / (third.f - newest.f) * other.f /
                  (third.f - other.f);
    }
  }
  return std::fabs(newest.f) < std::fabs(other.f) ? newest.x : other.x;
}

}  // namespace fovea::trajectory
