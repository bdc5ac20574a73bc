// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/resolve_constrained.hpp"

#include <algorithm>

#include "firmware/core/model/cholesky.hpp"

namespace fovea::control {
namespace {

constexpr double kSlowJoint = 1e-3;  // a task slower than this joint speed has no direction [rad/s]

// Adds to `H` = J^T J, in units of the task, the small cost weight^2 |d - dq_0|^2_W. `free` becomes the
// velocity d of least cost: dq_0 with the task almost at rest.
void WeighFreeMotion(const MotionTask& task, double weight, model::MatN& H, model::VecN& free) noexcept {
  free.resize(task.dq_0.size());
  for (Eigen::Index j = 0; j < free.size(); ++j) {
    const double cost = weight * weight * task.weight[j];
    H(j, j) += cost;
    free[j] = cost * task.dq_0[j];
  }
  model::MatN L = H;
  model::FactorCholesky(L);
  model::SolveLower(L, free);
  model::SolveLowerTransposed(L, free);
}

// The limits of the free motion beside the task's motion `u`. If `u` moves away from a limit, the free motion
// gets more room, so that a sum that keeps all limits stays unchanged. If `u` moves towards a limit, the room
// stays: otherwise the free motion would take all room from a task that comes to rest.
barriers::MotionLimits RoomBeside(const barriers::MotionLimits& limits, const model::VecN& u) noexcept {
  barriers::MotionLimits room = limits;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    room.dq_max[i] -= std::min(u[i], 0.0);
    room.dq_min[i] -= std::max(u[i], 0.0);
  }
  for (int k = 0; k < room.num_rows; ++k) {
    barriers::LimitRow& row = room.rows[static_cast<std::size_t>(k)];
    row.b -= std::min(row.a.dot(u), 0.0);
  }
  return room;
}

// Squared rms singular value of J W^-1/2: the unit of the task's cost.
double UnitOf(const MotionTask& task) noexcept {
  double unit = 0.0;
  for (Eigen::Index k = 0; k < task.J.cols(); ++k) {
    unit += task.J.col(k).squaredNorm() / task.weight[k];
  }
  unit /= static_cast<double>(task.J.rows());
  return unit > 0.0 ? unit : 1.0;  // no task: only the null space
}

}  // namespace

void ResolveConstrained(const ConstrainedConfig& config, const MotionTask& task,
                        const barriers::MotionLimits& limits, ConstrainedMotion& motion) noexcept {
  const DampedInverse inverse(config.damping, task);
  inverse.Resolve(task, motion.wish);
  motion.task_share = 1.0;
  motion.limited = LimitedMotion{};
  motion.limited.dq = motion.wish.dq;
  if (!motion.wish.finite) {
    barriers::ScaleIntoRange(limits, motion.limited.dq);
    motion.limited.outcome = LimitOutcome::kNotFinite;
    return;
  }
  // In damped directions a share of dq_0 disturbs the task. There, and if a limit is violated, the free part
  // of dq_0 is computed more sharply.
  const bool damped = motion.wish.sigma_min < motion.wish.threshold;
  if (!damped && limits.KeptBy(motion.wish.dq)) {
    return;
  }
  const Eigen::Index n = task.J.cols();
  const double unit = UnitOf(task);
  model::MatN JTJ(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      JTJ(i, j) = JTJ(j, i) = task.J.col(i).dot(task.J.col(j)) / unit;
    }
  }
  model::MatN H_free = JTJ;
  model::VecN free;
  WeighFreeMotion(task, config.free_weight, H_free, free);
  if (damped && free.allFinite()) {
    MotionTask sharper = task;
    sharper.dq_0 = free;
    inverse.Resolve(sharper, motion.wish);
    motion.limited.dq = motion.wish.dq;
    if (limits.KeptBy(motion.wish.dq)) {
      return;
    }
  }
  LimitedMotion free_limited;
  MoveIntoLimits(H_free, free, RoomBeside(limits, motion.wish.dq - free), free_limited);

  features::FeatureVector v(task.J.rows());  // of the wish: less than requested near a singularity
  v = task.J.lazyProduct(motion.wish.dq);
  // Cost (I - k v v^T) of the task's departure. slow2 keeps it continuous where v vanishes.
  const double slow2 = kSlowJoint * kSlowJoint * unit;
  const double k = (1.0 - config.progress_weight) / (v.squaredNorm() + slow2);
  const model::VecN g = task.J.transpose().lazyProduct(v);
  model::MatN H(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      H(i, j) = H(j, i) = JTJ(i, j) - k * g[i] * g[j] / unit;
    }
    H(j, j) += config.null_weight * config.null_weight * task.weight[j];
  }
  MoveIntoLimits(H, motion.wish.dq - free + free_limited.dq, limits, motion.limited);
  if (motion.limited.outcome == LimitOutcome::kFree) {  // the limits restrict dq_0 only
    const model::VecN dq = motion.limited.dq;
    motion.limited = free_limited;
    motion.limited.dq = dq;
  }

  const double v2 = v.squaredNorm();
  if (v2 > 0.0) {
    const features::FeatureVector left = task.J.lazyProduct(motion.limited.dq);
    motion.task_share = v.dot(left) / v2;
  }
}

}  // namespace fovea::control
