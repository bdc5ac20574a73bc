// SPDX-License-Identifier: Apache-2.0
// What an operator may do to a simulated run: pause it, move the target, pull the arm, break something,
// change a gain. Each request acts between two ticks. The live page's server has checked its values.
#pragma once

#include <cstdint>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/desk/servo_desk.hpp"
#include "firmware/host/desk/wall_pace.hpp"
#include "firmware/host/live/calls.hpp"
#include "firmware/host/live/catalogue.hpp"
#include "firmware/host/live/state.hpp"
#include "fovea/hal/record.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/operator/bench_hands.hpp"
#include "sim/operator/fault_desk.hpp"
#include "sim/run/sim_planner.hpp"
#include "sim/run/sim_vision.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// The parts of a run that an operator's requests change. All must outlive the desk.
struct DeskParts {
  const RunDescription& about;
  World& world;
  FaultyArm& arm;
  SimVision& vision;
  SimPlanner& planner;
  task::ServoLoop& loop;
  StallingClock& clock;
  desk::DeskReports reports;
};

enum class LiveEnd { kNone, kEnd, kReset };

// All functions from the thread that advances the world.
class OperatorDesk {
 public:
  // `speed`: see desk::WallPace.
  OperatorDesk(const DeskParts& parts, double speed);

  // What a run with this description offers, without channels.
  static live::Catalogue Offer(const RunDescription& about);

  // Carries out a call. An answer with an error changes nothing.
  live::Answer Do(const live::Call& call);
  // Call before each step of the world: places the target and pulls the arm for its present time.
  void Act() { hands_.Act(); }
  [[nodiscard]] const std::vector<live::Parameter>& parameters() const { return servo_.tuner().parameters(); }
  // Call with each record of the servo.
  void Note(const hal::TickRecord& record);

  [[nodiscard]] std::int64_t now_ns() const { return parts_.world.now_ns(); }
  [[nodiscard]] live::State State() const;
  [[nodiscard]] desk::WallPace& pace() { return pace_; }
  [[nodiscard]] LiveEnd end() const { return end_; }

 private:
  template <class Request>
  [[nodiscard]] live::Answer Take(const Request& request) {
    if constexpr (HandRequest<Request>) {
      return hands_.Take(request);
    } else {
      return servo_.Take(request);
    }
  }
  [[nodiscard]] live::Answer Take(const live::Pause& request);
  [[nodiscard]] live::Answer Take(const live::Step& request);
  [[nodiscard]] live::Answer Take(const live::Speed& request);
  [[nodiscard]] live::Answer Take(const live::Reset& request);
  [[nodiscard]] live::Answer Take(const live::Save& request);
  [[nodiscard]] live::Answer Take(const live::End& request);
  [[nodiscard]] live::Answer Take(const live::StartFault& request);
  [[nodiscard]] live::Answer Take(const live::StopFault& request);

  [[nodiscard]] double now_s() const { return static_cast<double>(parts_.world.now_ns()) * 1e-9; }
  void PassFaults();

  const DeskParts parts_;
  desk::WallPace pace_;
  BenchHands hands_;
  FaultDesk faults_;
  desk::ServoDesk servo_;
  LiveEnd end_ = LiveEnd::kNone;
};

}  // namespace fovea::sim
