// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/move_into_limits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/control/active_set.hpp"
#include "firmware/core/model/cholesky.hpp"

namespace fovea::control {
namespace {

using model::kMaxJoints;
using model::VecN;

constexpr double kBroken = 1e-10;       // a limit exceeded by more is violated [rad/s, normal of length 1]
constexpr double kAcceptBroken = 1e-9;  // a result that violates a limit by more is rejected
constexpr double kDependent = 1e-9;     // a normal this close to the span of others lies in it

// Limits are numbered: upper ends of the ranges, lower ends, rows.
constexpr int kFirstLower = kMaxJoints;
constexpr int kFirstRow = 2 * kMaxJoints;
constexpr int kNumLimits = kFirstRow + barriers::MotionLimits::kMaxRows;

// The limits with normals of length 1, and with dq_min <= dq_max.
struct Limits {
  Eigen::Index n = 0;
  VecN dq_min, dq_max;
  int num_rows = 0;
  std::array<barriers::LimitRow, barriers::MotionLimits::kMaxRows> rows;
  std::array<int, barriers::MotionLimits::kMaxRows> origin{};  // number of the given row
  bool contradict = false;                                     // a range is empty, or no dq keeps a row
  bool sound;                                                  // false: a value is NaN, or a row is missing

  explicit Limits(const barriers::MotionLimits& given) noexcept
      : n(given.dq_min.size()), dq_min(given.dq_min), dq_max(given.dq_max), sound(given.complete) {
    for (Eigen::Index i = 0; i < n; ++i) {
      sound = sound && !std::isnan(dq_min[i]) && !std::isnan(dq_max[i]);
      if (dq_min[i] > dq_max[i]) {
        contradict = true;
        dq_min[i] = dq_max[i] = std::fabs(dq_min[i]) < std::fabs(dq_max[i]) ? dq_min[i] : dq_max[i];
      }
    }
    for (int k = 0; k < given.num_rows; ++k) {
      const barriers::LimitRow& row = given.rows[static_cast<std::size_t>(k)];
      sound = sound && row.a.allFinite() && !std::isnan(row.b);
      const double largest = row.a.lpNorm<Eigen::Infinity>();
      if (!(largest > 0.0)) {
        contradict |= row.b < 0.0;  // does not depend on dq
        continue;
      }
      barriers::LimitRow& unit = rows[static_cast<std::size_t>(num_rows)];
      unit.a = row.a / largest;  // first, so that no square overflows
      const double size = unit.a.norm();
      unit.a /= size;
      unit.b = row.b / largest / size;
      origin[static_cast<std::size_t>(num_rows)] = k;
      ++num_rows;
    }
  }

  [[nodiscard]] bool Exists(int limit) const noexcept {
    return limit < kFirstRow ? limit % kMaxJoints < n : limit - kFirstRow < num_rows;
  }

  // By how much `dq` exceeds the limit.
  [[nodiscard]] double Passed(int limit, const VecN& dq) const noexcept {
    if (limit < kFirstLower) {
      return dq[limit] - dq_max[limit];
    }
    if (limit < kFirstRow) {
      return dq_min[limit - kFirstLower] - dq[limit - kFirstLower];
    }
    const barriers::LimitRow& row = rows[static_cast<std::size_t>(limit - kFirstRow)];
    return row.a.dot(dq) - row.b;
  }

  [[nodiscard]] VecN Normal(int limit) const noexcept {
    if (limit >= kFirstRow) {
      return rows[static_cast<std::size_t>(limit - kFirstRow)].a;
    }
    VecN normal = VecN::Zero(n);
    normal[limit % kMaxJoints] = limit < kFirstLower ? 1.0 : -1.0;
    return normal;
  }

  [[nodiscard]] VecN IntoRange(const VecN& dq) const noexcept {
    VecN inside(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      inside[i] = std::min(std::max(dq[i], dq_min[i]), dq_max[i]);
    }
    return inside;
  }

  [[nodiscard]] double MostRowPassed(const VecN& dq) const noexcept {
    double most = 0.0;
    for (int k = 0; k < num_rows; ++k) {
      most = std::max(most, Passed(kFirstRow + k, dq));
    }
    return most;
  }
};

static_assert(kNumLimits <= 64, "one bit each");

enum class Search : std::uint8_t { kDone, kGaveUp, kInfeasible };

// Moves `dq` from the wish to the nearest point that keeps all limits.
Search FindNearest(const model::MatN& L, const Limits& limits, VecN& dq, ActiveSet& active,
                   int& steps) noexcept {
  const double broken = kBroken + 1e-14 * dq.lpNorm<Eigen::Infinity>();
  int entering = -1;
  double entering_multiplier = 0.0;
  VecN whitened;
  for (steps = 0; steps < LimitedMotion::kMaxSteps; ++steps) {
    if (entering < 0) {
      double most = broken;
      for (int limit = 0; limit < kNumLimits; ++limit) {
        if (!limits.Exists(limit) ||
            (active.members >> static_cast<unsigned>(limit) & std::uint64_t{1}) != 0) {
          continue;
        }
        const double passed = limits.Passed(limit, dq);
        if (passed > most) {
          most = passed;
          entering = limit;
        }
      }
      if (entering < 0) {
        return Search::kDone;
      }
      entering_multiplier = 0.0;
      whitened = limits.Normal(entering);
      model::SolveLower(L, whitened);
    }
    // Direction towards the limit that keeps the active ones, and the change of their multipliers along it.
    VecN rest = whitened;
    std::array<double, kMaxJoints> along;
    active.Split(rest, along);
    std::array<double, kMaxJoints> change = along;
    active.SolveR(change);
    const double rest2 = rest.squaredNorm();
    const bool blocked =
        active.size == dq.size() || rest2 <= kDependent * kDependent * whitened.squaredNorm();
    const double full = blocked ? 0.0 : limits.Passed(entering, dq) / rest2;
    double step = full;
    int drop = -1;
    for (int k = 0; k < active.size; ++k) {
      const auto index = static_cast<std::size_t>(k);
      if (change[index] > 0.0) {
        const double until_zero = active.multiplier[index] / change[index];
        if ((blocked && drop < 0) || until_zero < step) {
          step = until_zero;
          drop = k;
        }
      }
    }
    if (blocked && drop < 0) {
      return Search::kInfeasible;
    }
    if (!blocked) {
      VecN towards = rest;
      model::SolveLowerTransposed(L, towards);
      dq -= step * towards;
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(active.size); ++k) {
      active.multiplier[k] -= step * change[k];
    }
    entering_multiplier += step;
    if (drop >= 0) {
      active.Drop(drop);
    } else {
      active.Add(entering, entering_multiplier, whitened, rest, along);
      entering = -1;
    }
  }
  return Search::kGaveUp;
}

// The point furthest from `rest` towards `goal` that keeps all limits; `rest` keeps them.
VecN GoAsFarAsKept(const Limits& limits, const VecN& rest, const VecN& goal) noexcept {
  const VecN way = limits.IntoRange(goal) - rest;
  double share = 1.0;
  for (int k = 0; k < limits.num_rows; ++k) {
    const double rise = limits.rows[static_cast<std::size_t>(k)].a.dot(way);
    const double room = std::max(-limits.Passed(kFirstRow + k, rest), 0.0);
    if (rise * share > room) {
      share = room / rise;
    }
  }
  return limits.IntoRange(rest + share * way);
}

}  // namespace

void MoveIntoLimits(const model::MatN& H, const VecN& dq_wish, const barriers::MotionLimits& limits_given,
                    LimitedMotion& motion) noexcept {
  const Limits limits(limits_given);
  const VecN at_rest = limits.IntoRange(VecN::Zero(limits.n));
  motion.steps = 0;
  motion.upper = motion.lower = motion.rows = 0;
  motion.dq = at_rest;
  model::MatN L = H;
  model::FactorCholesky(L);
  bool finite = limits.sound && dq_wish.allFinite();
  for (Eigen::Index i = 0; i < limits.n; ++i) {
    finite = finite && std::isfinite(L(i, i)) && L(i, i) > 0.0;
  }
  if (!finite) {
    motion.outcome = LimitOutcome::kNotFinite;
    return;
  }
  if (limits.contradict) {
    motion.outcome = LimitOutcome::kInfeasible;
    return;
  }
  VecN dq = dq_wish;
  ActiveSet active;
  const Search search = FindNearest(L, limits, dq, active, motion.steps);
  const bool rest_is_kept = limits.MostRowPassed(at_rest) <= kAcceptBroken;
  if (search == Search::kInfeasible && !rest_is_kept) {
    motion.outcome = LimitOutcome::kInfeasible;
    return;
  }
  const VecN nearest = limits.IntoRange(dq);
  if (search == Search::kDone && nearest.allFinite() && limits.MostRowPassed(nearest) <= kAcceptBroken) {
    motion.dq = nearest;
    motion.outcome = motion.steps == 0 ? LimitOutcome::kFree : LimitOutcome::kLimited;
    for (std::size_t k = 0; k < static_cast<std::size_t>(active.size); ++k) {
      const int limit = active.limit[k];
      if (limit < kFirstLower) {
        motion.upper |= 1U << static_cast<unsigned>(limit);
      } else if (limit < kFirstRow) {
        motion.lower |= 1U << static_cast<unsigned>(limit - kFirstLower);
      } else {
        motion.rows |=
            1U << static_cast<unsigned>(limits.origin[static_cast<std::size_t>(limit - kFirstRow)]);
      }
    }
    return;
  }
  if (!rest_is_kept) {
    motion.outcome = LimitOutcome::kInfeasible;
    return;
  }
  motion.outcome = LimitOutcome::kScaled;
  if (dq.allFinite()) {
    motion.dq = GoAsFarAsKept(limits, at_rest, dq);
  }
}

}  // namespace fovea::control
