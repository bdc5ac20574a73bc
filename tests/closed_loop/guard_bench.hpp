// SPDX-License-Identifier: Apache-2.0
// The servo's loop with the arm in Bullet, without a camera. Tests provoke what the guard watches, and check
// the arm tick by tick against the simulator's truth.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/planning/plan_desk.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world.hpp"
#include "sim/world/world_clock.hpp"
#include "tests/support/fake_drivers.hpp"
#include "tests/support/panda.hpp"

namespace fovea::test {

// The Panda of the scenario `ball` with its noise, friction and start. Each test changes what it needs.
struct GuardSetup {
  GuardSetup();
  config::ServoConfig servo;
  sim::WorldConfig world;
  sim::ArmFaults arm_faults;
  sim::StallFault stall;
  // The motion commanded at time t [s]; empty: none.
  std::function<moves::MotionCommand(const sim::Truth& truth, double t_s)> motion;
  // The target's position in B [m], measured 30 times a second, 40 ms late, noisy. Empty: no target.
  std::function<Eigen::Vector3d(double t_s)> target;
  // Changes each measurement; may be empty.
  std::function<void(hal::FeatureMeasurement& measurement)> spoil;
};

// Configures the plane of the table, the shape of the camera and its view, as every bench scenario does.
void TellTheBench(config::ServoConfig& servo);

// The record of a tick, and the time of the world; stamps in the record may be wrong.
struct GuardTick {
  int ms = 0;
  hal::TickRecord record;
};

// The extremes of a run. Shares are of the limits of the arm model.
struct GuardFigures {
  double torque = 0.0;        // share of its range
  double torque_rate = 0.0;   // share of the change allowed per tick
  double position = 0.0;      // share of half the range, from its middle
  double velocity = 0.0;      // share
  double radius = 0.0;        // |p_BE| [m]
  double speed = 0.0;         // of the end effector [m/s]
  double lowest = 1e9;        // smallest z of p_BE [m]
  double singular = 1e9;      // smallest singular value of the Jacobian, linear rows / 0.3 m
  double acceleration = 0.0;  // of the reference, share of what the guard allows
  double jerk = 0.0;          // of the reference, share of what the guard allows
  double wished_speed = 0.0;  // of the end effector in the reference [m/s]
  double turn = 0.0;          // of the end effector [rad/s]
  double wished_turn = 0.0;   // of the end effector in the reference [rad/s]
};

class GuardBench {
 public:
  explicit GuardBench(GuardSetup setup);
  GuardBench(const GuardBench&) = delete;
  GuardBench& operator=(const GuardBench&) = delete;

  void RunUntil(double t_s);
  void Ask(task::Request request) { loop_.Ask(request); }
  void Ask(config::MotionLawKind law) { loop_.Ask(law); }

  [[nodiscard]] const std::vector<GuardTick>& ticks() const { return ticks_; }
  [[nodiscard]] const GuardTick& last() const { return ticks_.back(); }
  [[nodiscard]] const GuardFigures& figures() const { return figures_; }
  [[nodiscard]] const sim::Truth& truth() const { return world_.truth(); }
  [[nodiscard]] const config::ServoConfig& config() const { return setup_.servo; }
  // The fastest joint at each millisecond from 0 on [rad/s].
  [[nodiscard]] const std::vector<double>& speeds() const { return speeds_; }

  // World time [ms] of the first tick, from `from_ms` on, with the limit active or in mode Fault; -1: none.
  [[nodiscard]] int FirstLimit(hal::Limit limit, int from_ms = 0) const;
  [[nodiscard]] int FirstFault() const;
  // The time after which every joint stays slower than 0.01 rad/s [ms].
  [[nodiscard]] int AtRest() const;

 private:
  void Watch(const sim::Truth& truth);
  void WatchReference(const hal::TickRecord& record);
  void See(const sim::Exposure& exposure);
  void HandOver(std::int64_t now_ns);

  struct Recorder final : hal::Recorder {
    explicit Recorder(GuardBench& owner) : bench(owner) {}
    void Record(const hal::TickRecord& record) noexcept override;
    GuardBench& bench;
  };
  struct Motion final : moves::MotionSource {
    explicit Motion(GuardBench& owner) : bench(owner) {}
    moves::MotionCommand At(std::int64_t now_ns) noexcept override;
    GuardBench& bench;
  };

  GuardSetup setup_;
  sim::World world_;
  sim::SimArm arm_;
  sim::FaultyArm faulty_arm_;
  sim::LockstepClock clock_;
  sim::StallingClock stalling_;
  hal::FeatureMailbox mailbox_;
  Recorder recorder_;
  Motion motion_;
  NoProbe probe_;
  task::ServoTask task_;
  planning::PlanDesk plans_;
  task::ServoLoop loop_;
  std::mt19937_64 random_{7};
  std::deque<std::pair<std::int64_t, hal::FeatureMeasurement>> under_way_;  // with the time of delivery
  std::vector<GuardTick> ticks_;
  std::vector<double> speeds_;
  GuardFigures figures_;
  Eigen::VectorXd tau_before_;
  Eigen::Vector3d p_before_;
  Eigen::Matrix3d R_before_;
};

// An attack: from `start_s` on, commands the hand to move at `velocity(truth)` [m/s] in B from where it is,
// without turning.
std::function<moves::MotionCommand(const sim::Truth&, double)> Attack(
    double start_s, std::function<Eigen::Vector3d(const sim::Truth&)> velocity);
// From `start_s` on, commands the joint goal `q`.
std::function<moves::MotionCommand(const sim::Truth&, double)> GoTo(double start_s, const Eigen::VectorXd& q);

// Limits that hold in every test: torque range and rate, acceleration and jerk of the reference. Unless the
// world itself pushes the arm, also joint range, velocity, and workspace within 1 mm.
enum class PushedBy { kServo, kWorld };
void ExpectInsideLimits(const GuardBench& bench, PushedBy by = PushedBy::kServo);
void PrintFigures(const std::string& what, const GuardBench& bench);

}  // namespace fovea::test
