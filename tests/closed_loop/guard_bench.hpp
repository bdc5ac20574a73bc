// The servo's loop with the arm in Bullet and no camera: what the guard watches is provoked here, and the arm
// is watched, tick by tick, from the simulator's truth.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world.hpp"
#include "sim/world/world_clock.hpp"
#include "tests/support/fake_drivers.hpp"
#include "tests/support/panda.hpp"

namespace fovea::test {

// The Panda of the scenario `ball`: its noise, its friction, its start. Who provokes changes what is needed.
struct GuardSetup {
  GuardSetup();
  config::ServoConfig servo;
  sim::WorldConfig world;
  sim::ArmFaults arm_faults;
  sim::StallFault stall;
  // What is commanded at the time t [s]; empty: nothing.
  std::function<moves::MotionCommand(const sim::Truth& truth, double t_s)> motion;
  // Where the target is in B [m]; the eye sees it 30 times a second, 40 ms late, with noise. Empty: no eye.
  std::function<Eigen::Vector3d(double t_s)> target;
  // The last word about a measurement.
  std::function<void(hal::FeatureMeasurement& measurement)> spoil;
};

// The servo is told its table, its camera and its picture, as every bench scenario tells it.
void TellTheBench(config::ServoConfig& servo);

// A tick, and the time of the world when it came; stamps may be off.
struct GuardTick {
  int ms = 0;
  hal::TickRecord record;
};

// The most that the arm really did, as shares of the arm's own limits.
struct GuardFigures {
  double torque = 0.0;       // of its range
  double torque_rate = 0.0;  // of what it may change per tick
  double position = 0.0;     // of half the joints' range, from its middle
  double velocity = 0.0;
  double radius = 0.0;        // |p_BE| [m]
  double speed = 0.0;         // of the end effector [m/s]
  double lowest = 1e9;        // p_BE's z [m]
  double singular = 1e9;      // smallest singular value of the hand's Jacobian, 1 / 0.3 m
  double acceleration = 0.0;  // of the reference, of what the guard allows it
  double jerk = 0.0;          // the same
  double wished_speed = 0.0;  // of the end effector as the reference moves it [m/s]
  double turn = 0.0;          // of the end effector [rad/s]
  double wished_turn = 0.0;   // as the reference turns it
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

  // World times [ms] of the first tick, from `from_ms` on, in which the limit acted or the fault stood; -1:
  // never.
  [[nodiscard]] int FirstLimit(hal::Limit limit, int from_ms = 0) const;
  [[nodiscard]] int FirstFault() const;
  // When every joint was slower than 0.01 rad/s for good [ms].
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
  task::ServoLoop loop_;
  std::mt19937_64 random_{7};
  std::deque<std::pair<std::int64_t, hal::FeatureMeasurement>> under_way_;  // by the time when it is due
  std::vector<GuardTick> ticks_;
  std::vector<double> speeds_;
  GuardFigures figures_;
  Eigen::VectorXd tau_before_;
  Eigen::Vector3d p_before_;
  Eigen::Matrix3d R_before_;
};

// The motions that attack: from `start_s` on the hand shall go with `velocity(truth)` [m/s] in B from
// wherever it is, turned as it is.
std::function<moves::MotionCommand(const sim::Truth&, double)> Attack(
    double start_s, std::function<Eigen::Vector3d(const sim::Truth&)> velocity);
// The joints shall come to rest at `q`.
std::function<moves::MotionCommand(const sim::Truth&, double)> GoTo(double start_s, const Eigen::VectorXd& q);

// What the arm may not pass, whatever is provoked: torque range and rate; and unless the provocation itself
// moves the arm there: joint range, velocity, workspace and 1 mm.
enum class PushedBy { kServo, kWorld };
void ExpectInsideLimits(const GuardBench& bench, PushedBy by = PushedBy::kServo);
void PrintFigures(const std::string& what, const GuardBench& bench);

}  // namespace fovea::test
