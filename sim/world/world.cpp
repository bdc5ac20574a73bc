// SPDX-License-Identifier: Apache-2.0
#include "sim/world/world.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
namespace {

constexpr double kStictionSpeed = 0.02;  // Coulomb friction reaches its full size beyond this [rad/s, m/s]
constexpr double kBrakeDecay = 0.8;      // share of the speed that an engaged brake leaves per step
constexpr double kBrakeRest = 1e-3;      // below this speed an engaged brake holds the joint [rad/s]

// The inertia of a single link about its own joint [kg m^2, kg].
double OwnInertia(const SimLink& link) {
  if (link.joint == SimJointKind::kPrismatic) {
    return link.mass;
  }
  const Eigen::Matrix3d I_L = link.X_LCom.linear() * link.I_Com * link.X_LCom.linear().transpose();
  return link.axis_L.dot(I_L * link.axis_L) +
         link.mass * link.axis_L.cross(link.X_LCom.translation()).squaredNorm();
}

BulletArmOptions WithLoad(BulletArmOptions options, const Load& load) {
  options.may_be_loaded = options.may_be_loaded || load.window.Begins();
  return options;
}

}  // namespace

World::World(const WorldConfig& config)
    : config_(config),
      arm_(config.robot, WithLoad(config.physics, config.load)),
      touch_(config.robot, config.target_body),
      random_(config.seed) {
  // The robot's controller compensates a share of the friction that it believes in. It may do so too much.
  const SimRobot& believed = config_.robot_truth.believed ? *config_.robot_truth.believed : config_.robot;
  for (std::size_t i = 0; i < config_.robot.links.size(); ++i) {
    const SimLink& link = config_.robot.links[i];
    if (link.dof >= 0) {
      // On a light link, the full friction of one step would reverse the speed. Each of its two parts
      // therefore removes at most half of the speed per step.
      const auto left = [&](double friction, double friction_believed) {
        return friction == friction_believed ? (1.0 - config_.friction_compensation) * friction
                                             : friction - config_.friction_compensation * friction_believed;
      };
      const double most =
          0.5 * OwnInertia(link) / hal::kTickPeriodS;  // damping of one part [N m s/rad, N s/m]
      viscous_.push_back(std::min(left(link.viscous, believed.links[i].viscous), most));
      coulomb_.push_back(left(link.coulomb, believed.links[i].coulomb));
      stiction_speed_.push_back(std::max(kStictionSpeed, std::fabs(coulomb_.back()) / most));
    }
  }
  if (config_.target.kind == MotionKind::kPushed) {
    ball_.emplace(config_.ball);
  }
  if (config_.robot_truth.believed) {
    BulletArmOptions options = config_.physics;
    options.table = false;
    believed_.emplace(believed, options);
  }
  arm_.SetState(config_.q_start - EncoderZero(),
                config_.dq_start.size() > 0 ? config_.dq_start : Eigen::VectorXd::Zero(arm_.num_dofs()));
  if (config_.stiction) {
    Eigen::VectorXd left(arm_.num_dofs());
    for (Eigen::Index i = 0; i < left.size(); ++i) {
      left[i] = std::max(coulomb_[static_cast<std::size_t>(i)], 0.0);
    }
    arm_.SetStiction(left);
  }
  command_.num_joints = arm_.num_dofs();
  measured_.num_joints = arm_.num_dofs();
  RecordTruth();
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

void World::Step() {
  truth_.ddq_disturbed.resize(0);
  if (command_.engage_brakes) {
    // The brakes stop each joint separately, whatever its load.
    Eigen::VectorXd dq = arm_.dq() * kBrakeDecay;
    for (Eigen::Index i = 0; i < dq.size(); ++i) {
      dq[i] = std::fabs(dq[i]) < kBrakeRest ? 0.0 : dq[i];
    }
    arm_.SetState(arm_.q() + dq * hal::kTickPeriodS, dq);
    arm_.FindContacts();
  } else {
    const double mass = config_.load.window.Contains(now_ns_) ? config_.load.mass : 0.0;
    const double tilt = config_.base_tilt.window.Contains(now_ns_) ? config_.base_tilt.tilt : 0.0;
    truth_.ddq_disturbed = AccelerationByDisturbance(mass, tilt);
    TakeUpLoad(mass);
    TiltBase(tilt);
    arm_.Step(JointTorque(), hal::kTickPeriodS);
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

Eigen::VectorXd World::EncoderZero() const {
  const Eigen::VectorXd& zero = config_.robot_truth.encoder_zero;
  return zero.size() > 0 ? zero : Eigen::VectorXd::Zero(arm_.num_dofs());
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
  const Eigen::VectorXd disturbed = MotorTorque() + Pulls();
  const Eigen::VectorXd wanted = UnimpairedTorque();
  if (mass == 0.0 && tilt == 0.0 && disturbed == wanted) {
    return {};
  }
  TakeUpLoad(mass);
  TiltBase(tilt);
  const Eigen::VectorXd ddq = arm_.ForwardDynamics(WithFriction(disturbed));
  TakeUpLoad(0.0);
  TiltBase(0.0);
  return ddq - arm_.ForwardDynamics(WithFriction(wanted));
}

// What the motors deliver without a fault: the command plus the gravity compensation of the robot's own
// controller.
Eigen::VectorXd World::UnimpairedTorque() const {
  Eigen::VectorXd tau = believed_ ? believed_->GravityTorque() : arm_.GravityTorque();
  tau += Eigen::Map<const Eigen::VectorXd>(command_.tau_cmd.data(), arm_.num_dofs());
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

// The joint friction that the robot's controller does not compensate [N m, N], without that of BulletArm.
double World::FrictionLeft(int joint, double velocity) const {
  const auto k = static_cast<std::size_t>(joint);
  if (config_.stiction) {
    return viscous_[k] * velocity;
  }
  return viscous_[k] * velocity + coulomb_[k] * std::tanh(velocity / stiction_speed_[k]);
}

// All torques on the joints: motors, springs, external pushes and the remaining friction.
Eigen::VectorXd World::JointTorque() const { return WithFriction(MotorTorque() + Pulls()); }

Eigen::VectorXd World::WithFriction(Eigen::VectorXd tau) const {
  for (int i = 0; i < arm_.num_dofs(); ++i) {
    tau[i] -= FrictionLeft(i, arm_.dq()[i]);
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

// What a joint's sensor reads of a motor's torque.
double World::SensedTorque(double tau, Eigen::Index joint) const {
  const RobotTruth& truth = config_.robot_truth;
  return truth.torque_scale.size() > 0 ? (tau - truth.torque_bias[joint]) / truth.torque_scale[joint] : tau;
}

double World::Quantised(double q) const {
  const double quantum = config_.encoder_quantum;
  return quantum > 0.0 ? quantum * std::round(q / quantum) : q;
}

void World::MeasureState() {
  measured_.stamp_ns = now_ns_;
  ++measured_.sequence;
  const Eigen::VectorXd motor = MotorTorque();
  const Eigen::VectorXd zero = EncoderZero();
  const Eigen::VectorXd stiction = arm_.StictionTorque();
  for (int i = 0; i < arm_.num_dofs(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    measured_.q[k] = Quantised(arm_.q()[i] + zero[i] + config_.encoder_noise * normal_(random_));
    measured_.dq[k] = arm_.dq()[i] + config_.velocity_noise * normal_(random_);
    measured_.tau_applied[k] = command_.tau_cmd[k];
    measured_.tau_meas[k] = SensedTorque(motor[i], i) - FrictionLeft(i, arm_.dq()[i]) + stiction[i];
  }
}

Exposure World::Look() const {
  Exposure exposure;
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
  if (now_ns_ + hal::kTickPeriodNs / 2 < due_ns) {
    return;
  }
  const std::uint64_t frame = next_frame_++;
  if (on_exposure_ && !config_.camera_outage.Contains(now_ns_)) {
    Exposure exposure = Look();
    exposure.sequence = frame;
    on_exposure_(std::move(exposure));
  }
}

}  // namespace fovea::sim
