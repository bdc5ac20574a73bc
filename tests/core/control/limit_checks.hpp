// SPDX-License-Identifier: Apache-2.0
// Shared by the tests of limits on joint velocities.
#pragma once

#include <algorithm>
#include <limits>

#include "firmware/core/barriers/motion_limits.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::control {

constexpr double kRowTolerance = 1.1e-9;  // allowed excess over a row, per length of its normal

inline model::VecN RandomVector(test::RandomStates& random, int n, double size) {
  model::VecN v(n);
  for (int i = 0; i < n; ++i) {
    v[i] = random.Uniform(-size, size);
  }
  return v;
}

// How far `dq` exceeds the limits: infinite past a range; otherwise the largest excess per length of a row.
inline double Broken(const barriers::MotionLimits& limits, const model::VecN& dq) {
  double most = 0.0;
  for (int i = 0; i < dq.size(); ++i) {
    if (!(dq[i] <= limits.dq_max[i] && dq[i] >= limits.dq_min[i])) {
      most = std::numeric_limits<double>::infinity();
    }
  }
  for (int k = 0; k < limits.num_rows; ++k) {
    const barriers::LimitRow& row = limits.rows[static_cast<std::size_t>(k)];
    if (row.a.norm() > 0.0) {
      most = std::max(most, (row.a.dot(dq) - row.b) / row.a.norm());
    }
  }
  return most;
}

}  // namespace fovea::control
