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

// All functions from the thread that advances the world. The live page's server has checked the requests'
// values.
class BenchHands {
 public:
  // Borrows `about` and `world`. `touch` is told what acts: its kind, and a sentence for a person.
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
  // Sets target and pull.
  void Fill(live::State& state) const;
  // Whether somebody has touched the target, so that the scenario no longer moves it.
  [[nodiscard]] bool target_touched() const { return hand_.At(world_.now_ns()).has_value(); }

 private:
  [[nodiscard]] Eigen::Isometry3d TargetPose() const;
  void LetArmGo();
  void LetTargetGo();

  const RunDescription& about_;
  World& world_;
  const Touch touch_;
  TargetHand hand_;
  std::int64_t dragged_ns_ = 0;  // when the last pose of a drag came
  std::optional<ArmSpring> spring_;
};

// The requests that BenchHands takes.
template <class Request>
concept HandRequest = requires(BenchHands& hands, const Request& request) {
  hands.Take(request);
};

}  // namespace fovea::sim
