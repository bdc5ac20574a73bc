// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
namespace {

constexpr double kBrakeDecay = 0.8;  // share of the speed that an engaged brake leaves per step
constexpr double kBrakeRest = 1e-3;  // below this speed an engaged brake holds the joint [rad/s]

Eigen::VectorXd RotorInertias(const SimRobot& robot) {
  Eigen::VectorXd inertias = Eigen::VectorXd::Zero(robot.num_dofs);
  for (const SimLink& link : robot.links) {
    if (link.dof >= 0) {
      inertias[link.dof] = link.rotor_inertia;
    }
  }
  return inertias;
}

BulletArmOptions WithLoad(BulletArmOptions options, const Load& load) {
  options.may_be_loaded = options.may_be_loaded || load.window.Begins();
  return options;
}

// Behind elastic joints the physics moves the links without the rotors.
SimRobot PhysicsRobot(const WorldConfig& config) {
  SimRobot robot = config.robot;
  for (SimLink& link : robot.links) {
    link.rotor_inertia = config.joint_springs.empty() ? link.rotor_inertia : 0.0;
  }
  return robot;
}

ElasticJointsConfig ElasticConfig(const WorldConfig& config, const JointFriction& friction) {
  const auto joints = static_cast<Eigen::Index>(config.joint_springs.size());
  ElasticJointsConfig elastic{Eigen::VectorXd(joints), Eigen::VectorXd(joints), RotorInertias(config.robot),
                              Eigen::VectorXd::Zero(joints)};
  for (Eigen::Index i = 0; i < joints; ++i) {
    elastic.stiffness[i] = config.joint_springs[static_cast<std::size_t>(i)].stiffness;
    elastic.damping[i] = config.joint_springs[static_cast<std::size_t>(i)].damping;
  }
  if (config.stiction) {
    elastic.holding = friction.Holding();
  }
  return elastic;
}

// The robot as its own controller thinks it is.
const SimRobot& BelievedRobot(const WorldConfig& config) {
  return config.robot_truth.believed ? *config.robot_truth.believed : config.robot;
}

}  // namespace

World::World(const WorldConfig& config)
    : config_(config),
      arm_(PhysicsRobot(config), WithLoad(config.physics, config.load)),
      touch_(config.robot, config.target_body),
      random_(config.seed),
      friction_(config.robot, BelievedRobot(config), config.friction_compensation, config.stiction,
                !config.joint_springs.empty()),
      rotor_inertia_(RotorInertias(config.robot)),
      rotor_torque_(Eigen::VectorXd::Zero(config.robot.num_dofs)),
      exposures_(config.exposure_reach_ns) {
  if (config_.target.kind == MotionKind::kPushed) {
    ball_.emplace(config_.ball);
  }
  // The controller does not see where elastic joints let the links go.
  if (config_.robot_truth.believed || !config_.joint_springs.empty()) {
    BulletArmOptions options = config_.physics;
    options.table = false;
    options.boxes.clear();
    believed_.emplace(BelievedRobot(config_), options);
  }
  const Eigen::VectorXd dq_start =
      config_.dq_start.size() > 0 ? config_.dq_start : Eigen::VectorXd::Zero(arm_.num_dofs());
  arm_.SetState(config_.q_start - EncoderZero(), dq_start);
  if (!config_.joint_springs.empty()) {
    elastic_.emplace(ElasticConfig(config_, friction_));
    Settle(dq_start);
  } else if (config_.stiction) {
    arm_.SetStiction(friction_.Holding());
  }
  command_.num_joints = arm_.num_dofs();
  measured_.num_joints = arm_.num_dofs();
  if (config_.velocity_filter_hz > 0.0) {
    for (const double dq : dq_start) {
      speeds_.emplace_back(config_.velocity_filter_hz, dq);
    }
  }
  RecordTruth();
  if (!config_.drives.empty()) {
    drives_.emplace(config_.drives, CommandedTorque());
  }
  MeasureState();
}

void World::OnStep(std::function<void(const Truth&)> callback) {
  on_step_ = std::move(callback);
  on_step_(truth_);
}

void World::OnExposure(std::function<void(Exposure)> callback) { on_exposure_ = std::move(callback); }

void World::AdvanceTo(std::int64_t time_ns) {
  while (now_ns_ + hal::kTickPeriodNs <= time_ns) {
    Step();
  }
}

void World::PlaceArm(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) {
  if (elastic_) {
    // The springs stay as they are.
    const Eigen::VectorXd rate = elastic_->motor_speed() - arm_.dq();
    Eigen::VectorXd q_links = q - EncoderZero();
    Eigen::VectorXd dq_links = dq;
    if (config_.encoder_on_motor) {
      q_links -= elastic_->deflection();
      dq_links -= rate;
    }
    arm_.SetState(q_links, dq_links);
    elastic_->SetMotorSpeed(dq_links + rate);
  } else {
    arm_.SetState(q - EncoderZero(), dq);
  }
  RecordTruth();
}

// At the start the springs carry the links' weight, and the encoders read q_start.
void World::Settle(const Eigen::VectorXd& dq) {
  constexpr int kRounds = 50;  // each divides the error by stiffness over change of weight
  elastic_->Settle(arm_.GravityTorque(), dq);
  for (int i = 0; i < kRounds && config_.encoder_on_motor; ++i) {
    arm_.SetState(config_.q_start - EncoderZero() - elastic_->deflection(), dq);
    elastic_->Settle(arm_.GravityTorque(), dq);
  }
}

Eigen::VectorXd World::MotorPosition() const {
  return elastic_ ? Eigen::VectorXd(arm_.q() + elastic_->deflection()) : arm_.q();
}

const Eigen::VectorXd& World::MotorSpeed() const { return elastic_ ? elastic_->motor_speed() : arm_.dq(); }

void World::Step() {
  truth_.ddq_disturbed.resize(0);
  if (drives_) {
    drives_->Step(CommandedTorque(), MotorPosition(), MotorSpeed());
  }
  if (command_.engage_brakes) {
    Brake();
  } else {
    const double mass = config_.load.window.Contains(now_ns_) ? config_.load.mass : 0.0;
    const double tilt = config_.base_tilt.window.Contains(now_ns_) ? config_.base_tilt.tilt : 0.0;
    truth_.ddq_disturbed = AccelerationByDisturbance(mass, tilt);
    TakeUpLoad(mass);
    TiltBase(tilt);
    StepArm();
  }
  StepBall();
  now_ns_ += hal::kTickPeriodNs;
  RecordTruth();
  MeasureState();
  ExposeIfDue();
  if (on_step_) {
    on_step_(truth_);
  }
}

// The brakes stop each joint separately, whatever its load. Springs keep their deflection.
void World::Brake() {
  Eigen::VectorXd dq = arm_.dq() * kBrakeDecay;
  for (Eigen::Index i = 0; i < dq.size(); ++i) {
    dq[i] = std::fabs(dq[i]) < kBrakeRest ? 0.0 : dq[i];
  }
  arm_.SetState(arm_.q() + dq * hal::kTickPeriodS, dq);
  arm_.FindContacts();
  rotor_torque_.setZero();  // the brakes hold the rotors
  if (elastic_) {
    elastic_->SetMotorSpeed(dq);
  }
}

void World::StepArm() {
  const Eigen::VectorXd dq_before = arm_.dq();
  if (elastic_) {
    const Eigen::VectorXd pulls = Pulls();
    const Eigen::VectorXd ddq_links = arm_.ForwardDynamics(pulls);
    elastic_->Step(WithFriction(MotorTorque()), dq_before, ddq_links, arm_.InverseMass(), hal::kTickPeriodS);
    arm_.Step(elastic_->torque() + pulls, hal::kTickPeriodS);
  } else {
    arm_.Step(JointTorque(), hal::kTickPeriodS);
    rotor_torque_ = rotor_inertia_.cwiseProduct(arm_.dq() - dq_before) / hal::kTickPeriodS;
  }
}

void World::StepBall() {
  if (!ball_) {
    return;
  }
  const auto push_ns = static_cast<std::int64_t>(std::llround(config_.ball_push_s * 1e9));
  if (now_ns_ <= push_ns && push_ns < now_ns_ + hal::kTickPeriodNs) {
    ball_->Push(config_.ball_push);
  }
  ball_->Step(hal::kTickPeriodS);
}

// Torques of the springs and of external pushes.
Eigen::VectorXd World::Pulls() const {
  Eigen::VectorXd tau = Eigen::VectorXd::Zero(arm_.num_dofs());
  if (config_.spring.size() > 0) {
    tau -= config_.spring.cwiseProduct(arm_.q());
  }
  if (config_.push.tau.size() > 0 && config_.push.window.Contains(now_ns_)) {
    tau += config_.push.tau;
  }
  if (pulled_.size() > 0) {
    tau += pulled_;
  }
  if (sprung_.size() > 0) {
    tau += sprung_;
  }
  return tau;
}

void World::TakeUpLoad(double mass) {
  if (config_.load.window.Begins()) {
    arm_.SetLoad(mass);
  }
}

// `tilt`: of the fault, in addition to the true tilt.
void World::TiltBase(double tilt) {
  if (MayTilt()) {
    const Eigen::Vector2d& always = config_.robot_truth.base_tilt;
    arm_.TiltBase(always.x() + tilt, always.y());
  }
}

bool World::MayTilt() const {
  return config_.base_tilt.window.Begins() || !config_.robot_truth.base_tilt.isZero(0.0);
}

// Difference of the next step's accelerations to those of an undisturbed arm, in the same state and under the
// same command. Empty if there is no disturbance. A wrong belief of the servo is none.
Eigen::VectorXd World::AccelerationByDisturbance(double mass, double tilt) {
  // Behind elastic joints a motor acts on the links through the springs alone.
  const Eigen::VectorXd disturbed = (elastic_ ? elastic_->torque() : MotorTorque()) + Pulls();
  const Eigen::VectorXd wanted = elastic_ ? elastic_->torque() : UnimpairedTorque();
  if (mass == 0.0 && tilt == 0.0 && disturbed == wanted) {
    return {};
  }
  TakeUpLoad(mass);
  TiltBase(tilt);
  const auto on_links = [this](const Eigen::VectorXd& tau) { return elastic_ ? tau : WithFriction(tau); };
  const Eigen::VectorXd ddq = arm_.ForwardDynamics(on_links(disturbed));
  TakeUpLoad(0.0);
  TiltBase(0.0);
  return ddq - arm_.ForwardDynamics(on_links(wanted));
}

// What the drives are told: the command plus the gravity compensation of the robot's own controller.
Eigen::VectorXd World::CommandedTorque() const {
  Eigen::VectorXd tau = believed_ ? believed_->GravityTorque() : arm_.GravityTorque();
  tau += Eigen::Map<const Eigen::VectorXd>(command_.tau_cmd.data(), arm_.num_dofs());
  return tau;
}

Eigen::VectorXd World::DriveError() const {
  return drives_ ? drives_->error() : Eigen::VectorXd::Zero(arm_.num_dofs());
}

// What the motors deliver without a fault.
Eigen::VectorXd World::UnimpairedTorque() const {
  Eigen::VectorXd tau = drives_ ? drives_->delivered() : CommandedTorque();
  const RobotTruth& truth = config_.robot_truth;
  if (truth.torque_scale.size() > 0) {
    tau = truth.torque_scale.cwiseProduct(tau) + truth.torque_bias;
  }
  return tau;
}

// What the motors deliver.
Eigen::VectorXd World::MotorTorque() const {
  Eigen::VectorXd tau = UnimpairedTorque();
  if (config_.torque_loss.window.Contains(now_ns_)) {
    tau[config_.torque_loss.joint] *= 1.0 - config_.torque_loss.share;
  }
  return tau;
}

// All torques on the joints: motors, springs, external pushes and the remaining friction.
Eigen::VectorXd World::JointTorque() const { return WithFriction(MotorTorque() + Pulls()); }

Eigen::VectorXd World::WithFriction(Eigen::VectorXd tau) const {
  for (int i = 0; i < arm_.num_dofs(); ++i) {
    tau[i] -= friction_.Torque(i, MotorSpeed()[i]);
  }
  return tau;
}

Eigen::Isometry3d World::TargetPose() const {
  if (placed_) {
    return *placed_;
  }
  if (ball_) {
    return ball_->X_BO();
  }
  Eigen::Isometry3d X_BO = Eigen::Isometry3d::Identity();
  X_BO.translation() = PositionAt(config_.target, now_ns_);
  X_BO.linear() = OrientationAt(config_.target, now_ns_);
  return X_BO;
}

void World::RecordTruth() {
  truth_.stamp_ns = now_ns_;
  truth_.q = arm_.q();
  truth_.dq = arm_.dq();
  truth_.tau_cmd = Eigen::Map<const Eigen::VectorXd>(command_.tau_cmd.data(), arm_.num_dofs());
  X_BL_.clear();
  for (int i = 0; i < static_cast<int>(config_.robot.links.size()); ++i) {
    X_BL_.push_back(arm_.LinkPose(i));
  }
  if (believed_) {
    believed_->SetState(Reading(), truth_.dq);
  }
  truth_.X_BE = X_BL_[static_cast<std::size_t>(config_.robot.tip)];
  truth_.X_BC = truth_.X_BE * config_.X_EC;
  const Eigen::Isometry3d X_BO = TargetPose();
  truth_.p_BO = X_BO.translation();
  truth_.R_BO = X_BO.linear();
  touch_.Place(X_BL_, X_BO);
  truth_.contacts = {arm_.Contacts(), touch_.Target(), touch_.Self()};
}

Exposure World::Look() const {
  Exposure exposure;
  exposure.time_ns = now_ns_;
  exposure.stamp_ns = now_ns_;
  exposure.X_BC = truth_.X_BC;
  exposure.p_BO = truth_.p_BO;
  exposure.R_BO = truth_.R_BO;
  exposure.X_BL = X_BL_;
  return exposure;
}

// Exposes at the step nearest to the frame's time by the camera's own clock. Its stamp is mid-exposure.
void World::ExposeIfDue() {
  const double period_ns = static_cast<double>(hal::kNsPerSecond) / config_.camera_rate_hz;
  const auto due_ns = config_.first_exposure_ns +
                      static_cast<std::int64_t>(std::llround(static_cast<double>(next_frame_) * period_ns));
  const bool due = now_ns_ + hal::kTickPeriodNs / 2 >= due_ns;
  const std::uint64_t frame = due ? next_frame_++ : next_frame_;
  if (!on_exposure_) {
    return;
  }
  const bool begins = due && !config_.camera_outage.Contains(now_ns_);
  if (begins || config_.exposure_reach_ns > 0) {
    exposures_.Add(Look());
  }
  if (begins) {
    exposures_.Begin(frame);
  }
  while (std::optional<Exposure> exposure = exposures_.TakeEnded()) {
    on_exposure_(*std::move(exposure));
  }
}

}  // namespace fovea::sim
