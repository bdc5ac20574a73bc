// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/motion_proof.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/guard/guard_motion.hpp"

namespace fovea::planning {
namespace {

constexpr double kLeastTravel = 2e-4;  // a motion that comes nearer to a bound is not proved [m]
constexpr int kGuardWork = 8;          // postures that a tick of the guard counts for

// Upper bounds of a plan in one of its spans: speed of any point of the arm [m/s], of the fastest joint.
struct Most {
  double speed = 0.0;
  double joint = 0.0;
};

Most MostIn(const PostureSpace& space, const trajectory::Plan& plan, int span) noexcept {
  Most most;
  for (int j = 0; j < plan.num_joints; ++j) {
    double step = 0.0;
    for (int k = 0; k < trajectory::Plan::kLeastPoints - 1; ++k) {
      step = std::max(step, std::fabs(plan.Point(span + k + 1, j) - plan.Point(span + k, j)));
    }
    most.speed += space.levers()[static_cast<std::size_t>(j)] * step / plan.period_s;
    most.joint = std::max(most.joint, step / plan.period_s);
  }
  return most;
}

}  // namespace

double FirstBlocked(const PostureSpace& space, const trajectory::Plan& plan, Work& work) noexcept {
  trajectory::Reference reference;
  Posture posture;
  double t = 0.0;
  for (int span = 0; span + trajectory::Plan::kLeastPoints <= plan.num_points; ++span) {
    const Most most = MostIn(space, plan, span);
    const double end = (span + 1) * plan.period_s;
    while (t < end) {
      plan.At(t, reference);
      space.Place(reference.q, work, posture);
      const PostureSpace::Verdict verdict = space.Judge(posture, 0.0);
      if (!work.IsLeft() || !verdict.is_free || !(verdict.travel > kLeastTravel)) {
        return t;
      }
      // Slower than the span's bounds, if it ends before: the next span has its own.
      const double step = std::min(verdict.travel / most.speed, kResolution / most.joint);
      t = t + step < end ? t + step : end;
    }
  }
  return -1.0;
}

bool IsLetPass(const PostureSpace& space, const trajectory::Plan& plan, double t,
               guard::KnownClearances& known, Work& work) noexcept {
  trajectory::Reference reference;
  trajectory::Reference next;
  plan.At(t, reference);
  plan.At(t + hal::kTickPeriodS, next);
  for (int i = 0; i < kGuardWork; ++i) {
    work.Spend();
  }
  const config::ServoConfig& config = space.config();
  model::ArmPoses poses;
  model::ComputePoses(config.arm, reference.q, poses);
  model::LinearJacobian J_E_B;
  model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J_E_B);
  guard::MotionWish wish;
  wish.dq = next.dq;
  wish.ddq = next.ddq;
  return guard::GuardMotion(config, wish, poses.X_BE.p, J_E_B, known, reference) == 0;
}

}  // namespace fovea::planning
