// SPDX-License-Identifier: Apache-2.0
// Episodes of a soak: a target, a disturbance, the operator's requests, and the outcome.
//
// All of it is drawn from a seed. After a fault the director acts as an operator: it waits until
// the arm is at rest, resets the servo and requests tracking again. If the servo holds with a
// reason, or no target is visible, it sends the arm home.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "firmware/core/task/servo_task.hpp"
#include "fovea/hal/record.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/verdict/target_error.hpp"
#include "sim/world/target_motion.hpp"
#include "sim/world/world.hpp"
#include "tests/soak/judge.hpp"
#include "tests/soak/seam.hpp"

namespace fovea::soak {

enum class Ending : std::uint8_t {
  kConverged,  // a still target, at its goal
  kFollowed,   // a moving target
  kHeld,       // the servo holds and reports the reason
  kUndefined,  // none of these within kLongestMs
};
inline constexpr std::array<const char*, 4> kEndingNames{"converged", "followed", "held", "undefined"};

// Figures of undisturbed episodes with a still target, for each tenth of the run.
struct Figures {
  Tenths error_px;    // true image error
  Tenths speed;       // rms of the joints' true speeds at the goal [rad/s]
  Tenths torque;      // rms of the commanded torques at the goal [Nm]
  Tenths covariance;  // trace of the estimated position's covariance [m^2]
  Tenths posture;     // the joints' distance from the ready posture [rad]
};

class Director final : public moves::MotionSource {
 public:
  Director(const sim::RunDescription& about, std::int64_t end_ns, std::uint64_t seed);

  // The world has reached `now_ns` with `truth`; `record` is the last tick's, `state` the servo's after it.
  void Step(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record,
            const task::ServoState& state);

  [[nodiscard]] Acting& acting() { return acting_; }
  // The request for the next tick; cleared by the call.
  [[nodiscard]] task::Request TakeRequest();
  // External torques on the joints [num_joints; Nm].
  [[nodiscard]] const Eigen::VectorXd& pull() const { return pull_; }
  [[nodiscard]] Eigen::Vector3d TargetAt(std::int64_t now_ns) const {
    return sim::PositionAt(target_, now_ns - episode_ns_);
  }
  [[nodiscard]] const Eigen::Matrix3d& R_BO() const { return target_.R_BO; }
  moves::MotionCommand At(std::int64_t now_ns) noexcept override;

  [[nodiscard]] const std::array<std::uint64_t, kEndingNames.size()>& endings() const { return endings_; }
  [[nodiscard]] const std::array<std::uint64_t, kTroubleNames.size()>& troubles() const { return troubles_; }
  [[nodiscard]] const std::map<std::string, std::uint64_t>& faults() const { return faults_; }
  [[nodiscard]] std::uint64_t recoveries() const { return recoveries_; }
  [[nodiscard]] std::uint64_t ways_home() const { return ways_home_; }
  [[nodiscard]] std::uint64_t ways_refused() const { return ways_refused_; }
  [[nodiscard]] const Figures& figures() const { return figures_; }
  // The first few unexpected events, as texts.
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }
  [[nodiscard]] std::uint64_t num_complaints() const { return num_complaints_; }

 private:
  void Begin(std::int64_t now_ns, const sim::Truth& truth);
  void LetTrouble(int ms);
  void Recover(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record);
  void GoHome(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record);
  void Measure(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record,
               const task::ServoState& state);
  void End(std::int64_t now_ns, const sim::Truth& truth, const hal::TickRecord& record);
  void Complain(std::int64_t now_ns, const std::string& what);
  [[nodiscard]] bool DrawTarget(const sim::Truth& truth);
  [[nodiscard]] bool IsInPicture(const sim::Truth& truth, const Eigen::Vector3d& p_BO) const;
  [[nodiscard]] double Uniform(double low, double high);

  const sim::RunDescription& about_;
  const sim::TargetGoal goal_;
  const Eigen::Matrix3d R_BO_still_;  // the scenario's orientation
  const std::int64_t end_ns_;
  std::mt19937_64 engine_;

  // the episode
  bool begun_ = false;
  std::int64_t episode_ns_ = 0;
  sim::TargetMotion target_;
  Trouble trouble_ = Trouble::kNone;
  int trouble_ms_ = 0;
  double strength_ = 0.0;
  Acting acting_;
  Eigen::VectorXd pull_;
  task::Request request_ = task::Request::kNone;

  // the motion home
  bool goes_home_ = false;
  std::int64_t home_ns_ = 0;
  bool home_begun_ = false;

  // measured in the episode's last half second
  Spread error_px_;
  Spread speed2_;
  Spread torque2_;
  double covariance_ = 0.0;

  // faults
  hal::Mode mode_before_ = hal::Mode::kBoot;
  bool asks_again_ = false;  // request Track once the servo holds after a recovery
  std::int64_t fault_ns_ = 0;

  std::array<std::uint64_t, kEndingNames.size()> endings_{};
  std::array<std::uint64_t, kTroubleNames.size()> troubles_{};
  std::map<std::string, std::uint64_t> faults_;
  std::uint64_t recoveries_ = 0;
  std::uint64_t ways_home_ = 0;
  std::uint64_t ways_refused_ = 0;
  Figures figures_;
  std::vector<std::string> complaints_;
  std::uint64_t num_complaints_ = 0;
};

}  // namespace fovea::soak
