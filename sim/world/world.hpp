// SPDX-License-Identifier: Apache-2.0
// The simulated bench: arm, target and time, in steps of 1 ms. It holds the true state.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "fovea/hal/arm.hpp"
#include "sim/drives/elastic_joints.hpp"
#include "sim/drives/joint_friction.hpp"
#include "sim/drives/speed_by_differences.hpp"
#include "sim/drives/torque_drives.hpp"
#include "sim/faults/bench_faults.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "sim/physics/link_touch.hpp"
#include "sim/physics/rolling_ball.hpp"
#include "sim/render/exposure.hpp"
#include "sim/world/exposure_history.hpp"
#include "sim/world/robot_truth.hpp"
#include "sim/world/target_motion.hpp"

namespace fovea::sim {

// Includes the faults of the bench.
struct WorldConfig : BenchFaults {
  SimRobot robot;
  RobotTruth robot_truth;
  BulletArmOptions physics;
  Eigen::VectorXd q_start;   // [num_dofs] as the encoders read
  Eigen::VectorXd dq_start;  // [num_dofs]; empty: at rest
  Eigen::VectorXd spring;    // [num_dofs] pulls each joint to 0 [Nm/rad, N/m]; empty: no springs
  Eigen::Isometry3d X_EC = Eigen::Isometry3d::Identity();
  double friction_compensation =
      0.9;                       // share of the joints' friction that the robot's own controller compensates
  bool stiction = false;         // true: Coulomb friction holds a joint at rest; false: smooth around rest
  double encoder_noise = 0.0;    // standard deviation of q [rad]
  double encoder_quantum = 0.0;  // q is measured in multiples of it [rad, m]; 0: not rounded
  double velocity_noise = 0.0;   // standard deviation of dq [rad/s], if it is not measured by differences
  double velocity_filter_hz = 0.0;         // corner frequency of SpeedByDifferences; 0: dq is the true speed
  std::vector<TorqueDriveConfig> drives;   // one per moving joint; empty: a torque acts at once and exactly
  std::vector<JointSpring> joint_springs;  // between motors and links, one per moving joint; empty: rigid
  bool encoder_on_motor = true;            // of a joint with a spring; otherwise on the link
  TargetMotion target;
  std::optional<Shape> target_body;  // the target's shape in O, for contacts with links; empty: no target
  RollingBallConfig ball;            // used for a pushed target
  Eigen::Vector3d ball_push = Eigen::Vector3d::Zero();  // impulse, in axes of B [N s]
  double ball_push_s = 0.0;                             // time of the push
  double camera_rate_hz = 30.0;
  std::int64_t first_exposure_ns = 20'000'000;
  std::int64_t exposure_reach_ns = 0;  // Shutter::ReachNs: from an exposure's middle to its end
  std::uint64_t seed = 1;
};

// The arm's contacts.
struct Contacts {
  int bench = 0;  // contact points of links with table and boxes
  bool target = false;
  bool self = false;
  [[nodiscard]] bool Any() const { return bench > 0 || target || self; }
};

// The true state at one instant. For verdicts and logs, never for the servo.
struct Truth {
  std::int64_t stamp_ns = 0;
  Eigen::VectorXd q;
  Eigen::VectorXd dq;
  Eigen::VectorXd tau_cmd;  // command of the last step
  // Share of the joints' accelerations in the last step caused by disturbances [rad/s^2, m/s^2]: pushes,
  // springs, faults of loads, base and motors, not by a wrong belief. Empty if there was none.
  Eigen::VectorXd ddq_disturbed;
  Eigen::Isometry3d X_BE = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_BO = Eigen::Matrix3d::Identity();
  Contacts contacts;
};

// Only one thread may use it.
class World {
 public:
  explicit World(const WorldConfig& config);

  // Calls `callback` at once, and then after each step.
  void OnStep(std::function<void(const Truth&)> callback);
  // Calls `callback` at the end of each exposure, on the thread that advances the world.
  void OnExposure(std::function<void(Exposure)> callback);

  // Steps until the world's time is `time_ns`, rounded down to a multiple of 1 ms.
  void AdvanceTo(std::int64_t time_ns);
  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }

  // Goes on from another state of the arm: joint positions `q` as the encoders read, and velocities `dq`
  // [num_dofs]. Time, the drives and all else stay; the measured state is that of the next step.
  void PlaceArm(const Eigen::VectorXd& q, const Eigen::VectorXd& dq);

  // Measurements and commands for SimArm.
  [[nodiscard]] const hal::ArmState& MeasuredState() const { return measured_; }
  void Command(const hal::ArmCommand& command) { command_ = command; }

  // Applies lasting external torques `tau` [num_dofs; Nm, N] to the joints, in addition to WorldConfig's.
  void PullAt(const Eigen::VectorXd& tau) { pulled_ = tau; }
  // The same for an operator's spring, which acts beside PullAt.
  void PullBySpring(const Eigen::VectorXd& tau) { sprung_ = tau; }
  // Changes the faults from now on. A load needs BulletArmOptions::may_be_loaded.
  void SetFaults(const BenchFaults& faults) { static_cast<BenchFaults&>(config_) = faults; }
  // From the next step on, the target is at `X_BO` instead of where the scenario moves it.
  void PlaceTarget(const Eigen::Isometry3d& X_BO) { placed_ = X_BO; }

  [[nodiscard]] const Truth& truth() const { return truth_; }
  // The joints as encoders without noise read them [rad, m].
  [[nodiscard]] Eigen::VectorXd Reading() const;
  // The joints' true velocities where the encoders are [rad/s, m/s].
  [[nodiscard]] const Eigen::VectorXd& ReadingSpeed() const;
  // How much the drives' torques of the last step differed from their command [num_dofs; Nm, N].
  [[nodiscard]] Eigen::VectorXd DriveError() const;
  // The bench as it is now, for a picture.
  [[nodiscard]] Exposure Look() const;
  [[nodiscard]] int num_joints() const { return arm_.num_dofs(); }

 private:
  void Step();
  void StepArm();
  void Brake();
  void Settle(const Eigen::VectorXd& dq);
  void MeasureState();
  void RecordTruth();
  void ExposeIfDue();
  [[nodiscard]] Eigen::VectorXd JointTorque() const;
  [[nodiscard]] const Eigen::VectorXd& MotorSpeed() const;
  [[nodiscard]] Eigen::VectorXd MotorPosition() const;
  [[nodiscard]] Eigen::VectorXd WithFriction(Eigen::VectorXd tau) const;
  [[nodiscard]] Eigen::VectorXd Pulls() const;
  [[nodiscard]] Eigen::VectorXd CommandedTorque() const;
  [[nodiscard]] Eigen::VectorXd UnimpairedTorque() const;
  [[nodiscard]] Eigen::VectorXd MotorTorque() const;
  [[nodiscard]] double SensedTorque(double tau, Eigen::Index joint) const;
  void TakeUpLoad(double mass);
  void TiltBase(double tilt);
  [[nodiscard]] bool MayTilt() const;
  [[nodiscard]] Eigen::VectorXd EncoderZero() const;
  [[nodiscard]] Eigen::VectorXd AccelerationByDisturbance(double mass, double tilt);
  void StepBall();
  [[nodiscard]] Eigen::Isometry3d TargetPose() const;

  WorldConfig config_;
  BulletArm arm_;
  std::optional<BulletArm> believed_;  // as the robot's own controller thinks it is, if that differs
  LinkTouch touch_;
  std::vector<Eigen::Isometry3d> X_BL_;  // of all links, by RecordTruth
  std::optional<RollingBall> ball_;
  std::optional<Eigen::Isometry3d> placed_;  // the target's pose, by PlaceTarget
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
  JointFriction friction_;
  Eigen::VectorXd rotor_inertia_;           // [num_dofs; kg m^2, kg]
  Eigen::VectorXd rotor_torque_;            // what accelerated the rotors in the last step [num_dofs; Nm, N]
  std::optional<TorqueDrives> drives_;      // none: ideal
  std::optional<ElasticJoints> elastic_;    // none: rigid
  std::vector<SpeedByDifferences> speeds_;  // one per moving joint; empty: dq is the true speed
  std::int64_t now_ns_ = 0;
  std::uint64_t next_frame_ = 0;
  ExposureHistory exposures_;
  hal::ArmCommand command_;
  Eigen::VectorXd pulled_;  // torques of PullAt; empty: none
  Eigen::VectorXd sprung_;  // torques of PullBySpring; empty: none
  hal::ArmState measured_;
  Truth truth_;
  std::function<void(const Truth&)> on_step_;
  std::function<void(Exposure)> on_exposure_;
};

}  // namespace fovea::sim
