// SPDX-License-Identifier: Apache-2.0
// What an operator may do to the bench itself, whoever runs the servo: hold, release and throw the target,
// and pull the arm by a spring. Each request acts between two steps of the world.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/state.hpp"
#include "sim/operator/arm_spring.hpp"
#include "sim/operator/target_hand.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// What the hands do at one instant. It has a fixed size: the thread that advances a served robot copies it
// without the heap.
struct HandsLook {
  // The target as viewers shall see it. While the time stands still and the target is dragged: where it will
  // be.
  Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
  bool holds_target = false;
  int pulled_link = -1;                            // index in SimRobot::links; -1: none
  Eigen::Vector3d p_BT = Eigen::Vector3d::Zero();  // where it is pulled to [m]
};

// Sets target and pull.
void Fill(const RunDescription& about, const HandsLook& look, live::State& state);

// All functions from the thread that advances the world. The live page's server has checked the requests'
// values.
class BenchHands {
 public:
  // Borrows `about` and `world`. `touch` is told what acts: its kind, and a sentence for a person. It may be
  // empty.
  using Touch = std::function<void(const std::string& what, const std::string& text)>;
  BenchHands(const RunDescription& about, World& world, Touch touch);

  // An answer with an error changes nothing.
  [[nodiscard]] live::Answer Take(const live::HoldTarget& request);
  [[nodiscard]] live::Answer Take(const live::ReleaseTarget& request);
  [[nodiscard]] live::Answer Take(const live::Throw& request);
  [[nodiscard]] live::Answer Take(const live::Pull& request);
  [[nodiscard]] live::Answer Take(const live::Release& request);
  // Releases target and arm.
  [[nodiscard]] live::Answer Take(const live::ControlEnded& request);

  // Call before each step of the world: places the target and pulls the arm for its present time.
  void Act();
  // Without a `touch`, these allocate nothing.
  void LetTargetGo();
  void LetArmGo();
  // `paused`: the time stands still. Allocates nothing.
  [[nodiscard]] HandsLook Look(bool paused) const;
  // Whether somebody has touched the target, so that the scenario no longer moves it.
  [[nodiscard]] bool target_touched() const { return hand_.At(world_.now_ns()).has_value(); }

 private:
  [[nodiscard]] Eigen::Isometry3d TargetPose() const;

  const RunDescription& about_;
  World& world_;
  const Touch touch_;
  TargetHand hand_;
  std::optional<ArmSpring> spring_;
};

// The requests that BenchHands takes.
template <class Request>
concept HandRequest = requires(BenchHands& hands, const Request& request) {
  hands.Take(request);
};

}  // namespace fovea::sim
