// SPDX-License-Identifier: Apache-2.0
#include "sim/verdict/barriers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
namespace {

using Kind = LimitBook::Kind;
using Value = std::optional<double>;

constexpr double kReboundLeft =
    0.99;  // share of an arm's rebound left per step; decays with 2.5 time constants of the law

// Signed distance from a point to the surface of a plane or box [m]; negative inside. Does not use the
// servo's function: the verdict must share no code with the servo.
double Distance(const config::Plane& plane, const Eigen::Vector3d& p) {
  return plane.normal.dot(p) - plane.distance;
}
double Distance(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d off = (box.min() - p).cwiseMax(p - box.max());  // beyond each pair of faces
  const double outside = off.cwiseMax(0.0).norm();
  return outside > 0.0 ? outside : off.maxCoeff();
}

// The largest absolute value of `share`(joint, i) over all joints; NaN if one is NaN.
template <typename Share>
double LargestOf(const model::ArmModel& arm, Share share) {
  double largest = 0.0;
  for (int i = 0; i < arm.num_joints; ++i) {
    const double used = std::fabs(share(arm.joints[static_cast<std::size_t>(i)], i));
    largest = std::isnan(largest) || used <= largest ? largest : used;
  }
  return largest;
}

void AddJoints(const model::ArmModel& arm, std::vector<TruthBarrier>& list) {
  const auto add = [&](const char* name, auto share) {
    list.push_back({name, Kind::kShare, [arm, share](const TruthStep& step) -> Value {
                      return LargestOf(
                          arm, [&](const model::Joint& joint, int i) { return share(step, joint, i); });
                    }});
  };
  add("joint_position", [](const TruthStep& step, const model::Joint& joint, int i) {
    return (step.now.q[i] - 0.5 * (joint.q_max + joint.q_min)) / (0.5 * (joint.q_max - joint.q_min));
  });
  add("joint_velocity",
      [](const TruthStep& step, const model::Joint& joint, int i) { return step.now.dq[i] / joint.dq_max; });
  add("torque", [](const TruthStep& step, const model::Joint& joint, int i) {
    return step.now.tau_cmd[i] / joint.tau_max;
  });
  add("torque_rate", [](const TruthStep& step, const model::Joint& joint, int i) {
    return step.before == nullptr
               ? 0.0
               : (step.now.tau_cmd[i] - step.before->tau_cmd[i]) / (joint.dtau_max * hal::kTickPeriodS);
  });
  // The servo is not responsible for disturbances, e.g. a fall with a dead motor. An acceleration counts only
  // as far as it also exists, in the same direction, without the disturbance: a reaction against the fall
  // does not count. The rebound after a disturbance does not count either.
  list.push_back({"true_joint_acceleration", Kind::kShare, [arm](const TruthStep& step) -> Value {
                    if (!step.mean_ddq) {
                      return std::nullopt;
                    }
                    return LargestOf(arm, [&](const model::Joint& joint, int i) {
                      const double ddq = (*step.mean_ddq)[i];
                      const auto of = [i](const Eigen::VectorXd& v) { return v.size() > 0 ? v[i] : 0.0; };
                      const double own = ddq - of(step.mean_ddq_disturbed);
                      const double counts = std::min(std::fabs(ddq), std::fabs(own)) - of(step.rebound);
                      return ddq * own <= 0.0 ? 0.0 : std::max(counts, 0.0) / joint.ddq_max;
                    });
                  }});
  // Reported, but not judged: a legal torque step on a light wrist exceeds the jerk limit.
  list.push_back({"true_joint_jerk", Kind::kShown, [arm](const TruthStep& step) -> Value {
                    if (!step.ddq || !step.ddq_before) {
                      return std::nullopt;
                    }
                    return LargestOf(arm, [&](const model::Joint& joint, int i) {
                      return ((*step.ddq)[i] - (*step.ddq_before)[i]) / (joint.dddq_max * hal::kTickPeriodS);
                    });
                  }});
}

void AddHand(const BarrierConfig& config, std::vector<TruthBarrier>& list) {
  list.push_back(
      {"workspace", Kind::kShare, [radius = config.workspace_radius](const TruthStep& step) -> Value {
         return step.now.X_BE.translation().norm() / radius;
       }});
  list.push_back(
      {"cartesian_speed", Kind::kShare, [most = config.cartesian_speed](const TruthStep& step) -> Value {
         if (step.before == nullptr) {
           return std::nullopt;
         }
         const Eigen::Vector3d way = step.now.X_BE.translation() - step.before->X_BE.translation();
         return way.norm() / (most * hal::kTickPeriodS);
       }});
  list.push_back(
      {"rotation_speed", Kind::kShare, [most = config.rotation_speed](const TruthStep& step) -> Value {
         if (step.before == nullptr) {
           return std::nullopt;
         }
         const Eigen::AngleAxisd turn(step.before->X_BE.linear().transpose() * step.now.X_BE.linear());
         return std::fabs(turn.angle()) / (most * hal::kTickPeriodS);
       }});
  const auto keep_out = [&](const char* name, int i, const auto& thing) {
    list.push_back({fmt::format("hand.{}[{}]", name, i), Kind::kClearance,
                    [thing, hand = config.hand](const TruthStep& step) -> Value {
                      double clearance = Distance(thing, step.now.X_BE.translation());
                      for (int k = 0; k < hand.num_balls; ++k) {  // camera and tools
                        const config::HandShape::Ball& ball = hand.balls[static_cast<std::size_t>(k)];
                        clearance =
                            std::min(clearance, Distance(thing, step.now.X_BE * ball.p_EP) - ball.radius);
                      }
                      return clearance;
                    }});
  };
  const config::Obstacles& obstacles = config.obstacles;
  for (int i = 0; i < obstacles.num_planes; ++i) {
    keep_out("planes", i, obstacles.planes[static_cast<std::size_t>(i)]);
  }
  for (int i = 0; i < obstacles.num_boxes; ++i) {
    const config::Box& box = obstacles.boxes[static_cast<std::size_t>(i)];
    keep_out("boxes", i, Eigen::AlignedBox3d(box.low, box.high));
  }
  for (std::size_t i = 0; i < config.boxes.size(); ++i) {
    keep_out("bench.boxes", static_cast<int>(i), config.boxes[i]);
  }
}

void AddContacts(std::vector<TruthBarrier>& list) {
  list.push_back({"contact_bench", Kind::kEvent,
                  [](const TruthStep& step) -> Value { return step.now.contacts.bench; }});
  list.push_back({"contact_target", Kind::kEvent,
                  [](const TruthStep& step) -> Value { return step.now.contacts.target ? 1.0 : 0.0; }});
  list.push_back({"contact_self", Kind::kEvent,
                  [](const TruthStep& step) -> Value { return step.now.contacts.self ? 1.0 : 0.0; }});
}

}  // namespace

std::vector<TruthBarrier> MakeTruthBarriers(const BarrierConfig& config) {
  std::vector<TruthBarrier> list;
  AddJoints(config.arm, list);
  AddHand(config, list);
  AddContacts(list);
  return list;
}

TruthBarriers::TruthBarriers(const BarrierConfig& config) {
  for (TruthBarrier& barrier : MakeTruthBarriers(config)) {
    const std::size_t entry = book_.Add(barrier.name, barrier.kind);
    list_.push_back({std::move(barrier), entry});
  }
}

void TruthBarriers::Add(const Truth& truth, hal::Mode mode) {
  if (mode == hal::Mode::kFault) {
    dq_.clear();
    ddq_disturbed_.clear();
  }
  dq_.push_back(truth.dq);
  ddq_disturbed_.push_back(truth.ddq_disturbed);
  if (dq_.size() > kMeanTicks + 1) {
    dq_.erase(dq_.begin());
    ddq_disturbed_.erase(ddq_disturbed_.begin());
  }
  TruthStep step{truth, before_ ? &*before_ : nullptr, {}, {}, {}, {}, {}};
  const std::size_t n = dq_.size();
  if (n == kMeanTicks + 1) {
    step.mean_ddq = (dq_.back() - dq_.front()) / (kMeanTicks * hal::kTickPeriodS);
    for (std::size_t i = 1; i < n; ++i) {  // the kMeanTicks steps between the n velocities
      if (ddq_disturbed_[i].size() > 0) {
        if (step.mean_ddq_disturbed.size() == 0) {
          step.mean_ddq_disturbed.setZero(truth.dq.size());
        }
        step.mean_ddq_disturbed += ddq_disturbed_[i] / kMeanTicks;
      }
    }
    step.ddq = (dq_[n - 1] - dq_[n - 2]) / hal::kTickPeriodS;
    step.ddq_before = (dq_[n - 2] - dq_[n - 3]) / hal::kTickPeriodS;
  }
  // A rebound comes from past disturbances: the present disturbance is subtracted.
  rebound_ *= kReboundLeft;
  step.rebound = rebound_;
  if (truth.ddq_disturbed.size() > 0) {
    const Eigen::VectorXd now = truth.ddq_disturbed.cwiseAbs();
    if (rebound_.size() == 0) {
      rebound_.setZero(now.size());
    }
    step.rebound = (rebound_ - now).cwiseMax(0.0);
    rebound_ = rebound_.cwiseMax(now);
  }
  for (const Listed& listed : list_) {
    if (const std::optional<double> value = listed.barrier.value(step)) {
      book_.Note(truth.stamp_ns, listed.entry, *value);
    }
  }
  before_ = truth;
}

}  // namespace fovea::sim
