#include "fovea/servo/resolve_constrained.hpp"

#include <cmath>

namespace fovea::servo {
namespace {

constexpr double kSlowJoint =
    1e-3;  // a task slower than joints at this speed move it has no direction [rad/s]

}  // namespace

void ResolveConstrained(const ConstrainedConfig& config, const MotionTask& task, const MotionLimits& limits,
                        ConstrainedMotion& motion) noexcept {
  ResolveDamped(config.damping, task, motion.wish);
  motion.task_share = 1.0;
  motion.limited = LimitedMotion{};
  motion.limited.dq = motion.wish.dq;
  if (!motion.wish.finite) {
    ScaleIntoRange(limits, motion.limited.dq);
    motion.limited.outcome = LimitOutcome::kNotFinite;
    return;
  }
  if (limits.KeptBy(motion.wish.dq)) {
    return;
  }
  const Eigen::Index m = task.J.rows();
  const Eigen::Index n = task.J.cols();
  features::FeatureVector v(m);  // of the wish: near a singularity not all that was asked for
  v = task.J.lazyProduct(motion.wish.dq);

  // rms singular value of J W^-1/2, squared: the unit in which the task counts.
  double unit = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    unit += task.J.col(k).squaredNorm() / task.weight[k];
  }
  unit /= static_cast<double>(m);
  if (!(unit > 0.0)) {
    unit = 1.0;  // no task: the null space is all there is
  }
  // Cost (I - k v v^T) of the task's departure. The second term keeps it continuous where v vanishes.
  const double slow2 = kSlowJoint * kSlowJoint * unit;
  const double k = (1.0 - config.progress_weight) / (v.squaredNorm() + slow2);
  const model::VecN g = task.J.transpose().lazyProduct(v);
  model::MatN H(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      H(i, j) = (task.J.col(i).dot(task.J.col(j)) - k * g[i] * g[j]) / unit;
      H(j, i) = H(i, j);
    }
    H(j, j) += config.null_weight * config.null_weight * task.weight[j];
  }
  MoveIntoLimits(H, motion.wish.dq, limits, motion.limited);

  const double v2 = v.squaredNorm();
  if (v2 > 0.0) {
    const features::FeatureVector left = task.J.lazyProduct(motion.limited.dq);
    motion.task_share = v.dot(left) / v2;
  }
}

}  // namespace fovea::servo
