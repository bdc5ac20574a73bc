// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/bench_hands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fovea::sim {
namespace {

constexpr std::int64_t kBetweenDrags = 500'000'000;  // a pause of a drag that begins another one [ns]

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
  if (!spring_) {
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
    touch_("pull", "the arm is let go");
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
  const std::int64_t now_ns = world_.now_ns();
  if (!hand_.held() || now_ns - dragged_ns_ > kBetweenDrags) {
    touch_("target", fmt::format("the target is taken at {}", InMetres(world_.truth().p_BO)));
  }
  dragged_ns_ = now_ns;
  hand_.Drag(TargetPose(), wish, now_ns);
  return {};
}

live::Answer BenchHands::Take(const live::ReleaseTarget& /*request*/) {
  LetTargetGo();
  return {};
}

void BenchHands::LetTargetGo() {
  if (hand_.held()) {
    hand_.Release();
    touch_("target", fmt::format("the target is let go at {}", InMetres(world_.truth().p_BO)));
  }
}

live::Answer BenchHands::Take(const live::Throw& request) {
  const Eigen::Vector3d v_BO = ToVector(request.v_BO);
  hand_.Throw(TargetPose(), v_BO, ToVector(request.omega_B), world_.now_ns());
  touch_("target",
         fmt::format("the target is thrown at {:.2f} m/s", std::min(v_BO.norm(), TargetHand::kMostSpeed)));
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

void BenchHands::Fill(live::State& state) const {
  if (about_.scene.has_eye) {
    const Truth& truth = world_.truth();
    const Eigen::Quaterniond q(truth.R_BO);
    state.target = live::TargetState{ToArray(truth.p_BO), {q.w(), q.x(), q.y(), q.z()}, hand_.held()};
  }
  if (spring_) {
    const auto link = static_cast<std::size_t>(spring_->link);
    state.pull = live::PullState{about_.scene.robot.links[link].name, ToArray(spring_->p_BT)};
  }
}

}  // namespace fovea::sim
