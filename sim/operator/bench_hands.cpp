// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/bench_hands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fovea::sim {
namespace {

// The lowest centre of the target that leaves it above the table [m].
double LeastHeight(const RunDescription& about) {
  const bool is_ball = about.scene.has_eye && about.scene.target.kind == TargetShape::Kind::kBall;
  return is_ball ? about.scene.target.radius : 0.0;
}

Eigen::Vector3d ToVector(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

std::array<double, 3> ToArray(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

std::string InMetres(const Eigen::Vector3d& p) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) m", p.x(), p.y(), p.z());
}

std::optional<int> LinkByName(const SimRobot& robot, const std::string& name) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    if (robot.links[i].name == name) {
      return static_cast<int>(i);
    }
  }
  return std::nullopt;
}

}  // namespace

BenchHands::BenchHands(const RunDescription& about, World& world, Touch touch)
    : about_(about), world_(world), touch_(std::move(touch)), hand_(LeastHeight(about)) {}

live::Answer BenchHands::Take(const live::Pull& request) {
  const std::optional<int> link = LinkByName(about_.scene.robot, request.link);
  if (!link) {
    return {fmt::format("the arm has no link \"{}\"", request.link), "{}"};
  }
  if (!spring_ && touch_) {
    touch_("pull", fmt::format("the arm is pulled at {}", request.link));
  }
  spring_ = ArmSpring{*link, ToVector(request.p_link), ToVector(request.to_B)};
  return {};
}

live::Answer BenchHands::Take(const live::Release& /*request*/) {
  LetArmGo();
  return {};
}

void BenchHands::LetArmGo() {
  if (spring_) {
    spring_.reset();
    world_.PullBySpring(Eigen::VectorXd());
    if (touch_) {
      touch_("pull", "the arm is let go");
    }
  }
}

Eigen::Isometry3d BenchHands::TargetPose() const {
  Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
  X_BO.translation() = world_.truth().p_BO;
  X_BO.linear() = world_.truth().R_BO;
  return X_BO;
}

live::Answer BenchHands::Take(const live::HoldTarget& request) {
  Eigen::Isometry3d wish = Eigen::Isometry3d::Identity();
  wish.translation() = ToVector(request.p_BO);
  const auto& q = request.q_BO;
  wish.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  if (wish.translation().cwiseAbs().maxCoeff() > TargetHand::kFarthest) {
    return {fmt::format("the target must stay within {:g} m of the base", TargetHand::kFarthest), "{}"};
  }
  if (!hand_.held() && touch_) {
    touch_("target", fmt::format("the target is taken at {}", InMetres(world_.truth().p_BO)));
  }
  hand_.Drag(TargetPose(), wish, world_.now_ns());
  return {};
}

live::Answer BenchHands::Take(const live::ReleaseTarget& /*request*/) {
  LetTargetGo();
  return {};
}

void BenchHands::LetTargetGo() {
  if (hand_.held()) {
    hand_.Release();
    if (touch_) {
      touch_("target", fmt::format("the target is let go at {}", InMetres(world_.truth().p_BO)));
    }
  }
}

live::Answer BenchHands::Take(const live::Throw& request) {
  const Eigen::Vector3d v_BO = ToVector(request.v_BO);
  hand_.Throw(TargetPose(), v_BO, ToVector(request.omega_B), world_.now_ns());
  if (touch_) {
    touch_("target",
           fmt::format("the target is thrown at {:.2f} m/s", std::min(v_BO.norm(), TargetHand::kMostSpeed)));
  }
  return {};
}

live::Answer BenchHands::Take(const live::ControlEnded& /*request*/) {
  LetTargetGo();
  LetArmGo();
  return {};
}

void BenchHands::Act() {
  if (const std::optional<Eigen::Isometry3d> X_BO = hand_.At(world_.now_ns())) {
    world_.PlaceTarget(*X_BO);
  }
  if (spring_) {
    world_.PullBySpring(SpringTorque(*spring_, about_.scene.robot, world_.Look().X_BL, world_.truth().dq));
  }
}

HandsLook BenchHands::Look(bool paused) const {
  HandsLook look;
  const std::optional<Eigen::Isometry3d> goal = hand_.Goal();
  look.X_BO = paused && goal ? *goal : TargetPose();
  look.holds_target = hand_.held();
  if (spring_) {
    look.pulled_link = spring_->link;
    look.p_BT = spring_->p_BT;
  }
  return look;
}

void Fill(const RunDescription& about, const HandsLook& look, live::State& state) {
  if (about.scene.has_eye) {
    const Eigen::Quaterniond q(look.X_BO.linear());
    state.target =
        live::TargetState{ToArray(look.X_BO.translation()), {q.w(), q.x(), q.y(), q.z()}, look.holds_target};
  }
  if (look.pulled_link >= 0) {
    const auto link = static_cast<std::size_t>(look.pulled_link);
    state.pull = live::PullState{about.scene.robot.links[link].name, ToArray(look.p_BT)};
  }
}

}  // namespace fovea::sim
