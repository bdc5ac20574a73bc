// Everything that can be set about the servo. Fixed after Init; each field is the configuration key of the
// same name in the section that its struct names, with the unit in brackets.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/arm_model.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::config {

// Planes n p >= d and boxes, in B.
struct Plane {
  model::Vec3 normal = model::Vec3::UnitZ();  // of length 1
  double distance = 0.0;                      // [m]
};
struct Box {
  model::Vec3 low = model::Vec3::Zero();   // [m]
  model::Vec3 high = model::Vec3::Zero();  // [m]
};

// [servo] where the feature is now
struct PredictConfig {
  bool enabled = true;       // servo.predict; false: the newest measurement as it came, held
  double target_jerk = 1.0;  // how fast the target's acceleration may be thought to change [m/s^3]
  double target_turn = 0.1;  // and its angular velocity, of a target whose orientation is seen [rad/s^2]
  double gate_sigma = 6.0;   // a measurement further off than this is an outlier [sigma]
  int gate_rejects_max = 3;  // so many outliers in a row, and the target has moved: start anew
  int accepted_min = 3;      // measurements before the target counts as known
  double stale_s = 0.15;     // a measurement older than this is no longer fresh [s]
  double coast_s = 0.6;      // steer by prediction for so long after the last measurement [s]

  // What no measurement can make the target be: its motion is cut down to this, and a place outside is
  // refused.
  double target_speed_max = 1.0;                                               // [m/s]
  double target_acceleration_max = 5.0;                                        // [m/s^2]
  double target_turn_max = 3.0;                                                // angular velocity [rad/s]
  Box target_region{model::Vec3::Constant(-3.0), model::Vec3::Constant(3.0)};  // of its centre

  // servo.stuck_shift_px in the normalised image: a picture that stays the same while the hand moved the
  // scene in it by more than this is no measurement.
  double stuck_shift = 0.0036;

  double way_in_vain = 0.5;  // the camera may go so far without its error getting smaller [m]

  // How wrong the calibration may be, standard deviations (measurement_doubt.hpp).
  double stamp_sigma = 0.004;        // of the measurements' stamps against the arm's [s]
  double mount_shift_sigma = 0.005;  // of the camera's place in the hand [m]
  double mount_turn_sigma = 0.02;    // of its orientation [rad]
  double scale_sigma = 0.02;         // of focal length and target size, as a share
};

// [servo] the interaction matrix that the law inverts: of now, of the goal, or the mean of both
enum class Interaction : std::uint8_t { kCurrent, kDesired, kMean };
inline constexpr std::array<const char*, 3> kInteractionNames{"current", "desired", "mean"};

// [servo] how the arm shall move
struct LawConfig {
  double lambda = 2.0;         // e decays like exp(-lambda t) [1/s]
  double lambda_near = 0.0;    // the gain towards e = 0, `lambda` being that of large e; 0: the same
  double lambda_slope = 30.0;  // how fast it changes with |e| at e = 0 [1/s per unit of e]
  Interaction interaction = Interaction::kCurrent;
  double smooth_start_s = 0.25;        // the law's velocity is blended in over this time [s]
  double damping = 0.05;               // begins at this share of the task Jacobian's rms singular value
  double posture_gain = 0.6;           // pull of the posture in the free directions [1/s]
  double joint_limit_gain = 0.0;       // and away from the ends of the joints' ranges [1/s]
  double manipulability_gain = 0.0;    // and towards more manipulability [rad^2/s]
  double free_speed = 0.3;             // all of these together no faster [rad/s]
  hal::JointArray q_posture{};         // that posture [rad]; the arm's ready posture by default
  double unreachable_s = 1.0;          // give up when limits have kept the arm from the goal for so long [s]
  double unreachable_progress = 0.05;  // "kept from": less than this share of the wanted motion is left
};

// [servo] the inner loop; the laws are in motion_law.hpp
enum class MotionLawKind : std::uint8_t { kComputedTorque, kPd, kJointImpedance, kOperationalSpace, kFloat };
inline constexpr int kNumMotionLaws = 5;

struct MotionLawConfig {
  MotionLawKind kind = MotionLawKind::kComputedTorque;  // servo.motion_law
  double omega_n = 25.0;                                // natural frequency of the joints' error [rad/s]
  double zeta = 1.0;                                    // its damping
  double integral = 0.0;                  // how fast an error that stays is made up for [1/s]; 0: not
  double integral_torque_fraction = 0.2;  // with at most this share of a joint's torque
  hal::JointArray k_p{};                  // stiffness of pd and joint_impedance [Nm/rad]
  hal::JointArray k_v{};                  // their damping [Nm s/rad]
  bool damp_by_inertia = true;            // joint_impedance: damping from zeta and the inertia, not k_v
  double friction_compensation = 0.0;     // share of the joints' friction that the servo makes up for
  double friction_width = 1e-3;           // the sign of a speed is smooth within this [rad/s]
  double friction_slow = 0.02;            // below it the reference's speed has the say [rad/s]
  double operational_damping = 1e-3;      // of operational_space near a singularity, relative
  double change_s = 0.2;                  // time in which one law takes over from another [s]
};

// What the hand keeps out of.
struct Obstacles {
  static constexpr int kMost = 4;  // of each
  int num_planes = 0;
  int num_boxes = 0;
  std::array<Plane, kMost> planes;
  std::array<Box, kMost> boxes;
};

// What is bolted to the hand, as balls: the camera from the flange to its lens, and tools.
struct HandShape {
  static constexpr int kMost = 24;
  struct Ball {
    model::Vec3 p_EP = model::Vec3::Zero();  // its middle, in axes of E [m]
    double radius = 0.0;                     // [m]
  };
  int num_balls = 0;
  std::array<Ball, kMost> balls;

  // Adds a capsule from `p_EA` to `p_EB` [m in E] with `radius` [m] as balls that cover it. False, with only
  // a part added, when there is no room.
  [[nodiscard]] bool AddCapsule(const model::Vec3& p_EA, const model::Vec3& p_EB, double radius) noexcept;
};

// [safety] what the target is kept in: the picture less a margin, in the normalised image
struct ViewConfig {
  bool enabled = false;
  double x_min = 0.0;
  double x_max = 0.0;
  double y_min = 0.0;
  double y_max = 0.0;
  double face_cosine_min = 0.0;  // of a disc's tilt against the line of sight; 0: any
};

// [safety] limits on the motion, as fractions of the arm's own or in their units
struct GuardConfig {
  double joint_velocity_fraction = 0.8;
  double joint_acceleration_fraction = 0.7;
  double joint_jerk_fraction = 0.025;   // gentle: more asks for torque steps past their rate far out
  double joint_position_margin = 0.02;  // the reference stays so far inside the range [rad, m]
  double braking_fraction = 0.5;        // of the acceleration limit, for stopping before a barrier
  double workspace_radius = 0.85;       // |p_BE| stays below this [m]
  double workspace_margin = 0.002;      // the reference stays so far inside [m]
  double workspace_deceleration = 2.0;  // for stopping before it [m/s^2]
  double cartesian_speed = 1.7;         // of the end effector [m/s]
  double singularity_min = 0.02;        // smallest singular value of the hand's Jacobian, 1 / 0.3 m
  Obstacles obstacles;                  // which hand and arm keep out of
  HandShape hand;                       // what moves with the end effector
  double link_radius = 0.06;            // of the links from the elbow on, before planes [m]
  ViewConfig view;                      // safety.keep_in_view, view_margin_px, face_tilt_max
  double sight_clearance = 0.08;        // of the links' lines from those to the target [m]; 0: any
  double hand_clearance = 0.13;         // of the hand's line from those of the arm's first links [m]; 0: any
};

// [safety] limits on the torque, and when to stop altogether
struct SafetyConfig {
  double torque_fraction = 1.0;
  double torque_rate_fraction = 1.0;
  int arm_lost_ticks = 20;               // so many ticks without a new sound state: fault
  int non_finite_ticks = 5;              // a non-finite joint value is bridged for so many ticks, then: fault
  int missed_ticks = 20;                 // so many missed deadlines in a row: fault
  int boot_ticks = 20;                   // sound states in a row before Boot is over
  double boot_velocity = 0.05;           // and every joint slower than this [rad/s, m/s]
  double stiction_fraction = 0.5;        // of a joint's Coulomb friction may hold it still, unseen
  int frozen_ticks = 20;                 // a joint that flickers may repeat itself to the bit so often
  double encoder_quantum = 1e-4;         // a joint's reading changes in steps no larger than this [rad, m]
  double setpoint_jump = 1e-3;           // a stream of setpoints starts and goes on this close [rad, m]
  double following_error = 0.15;         // a joint further off its reference: fault [rad, m]
  double motion_error = 0.05;            // and on the whole further in a commanded motion: Hold [rad, m]
  double contact_torque_fraction = 0.2;  // pushed with more than this share of a joint's torque: fault
  double contact_gain = 60.0;            // of the observer that sees it [1/s]
  double carried_torque_fraction = 0.1;  // where the arm stands, it carries what it sees with at most so much
  double fault_damping = 10.0;           // of the damped stop [1/s]
  double brake_velocity = 0.02;          // brakes close when every joint is slower [rad/s, m/s]
  double brake_after_s = 0.3;            // or after this time [s]
};

// [servo] commanded motions of the end effector
struct MoveConfig {
  double speed = 0.5;              // [m/s]
  double acceleration = 2.0;       // [m/s^2]
  double jerk = 20.0;              // [m/s^3]
  double turn_speed = 1.0;         // [rad/s]
  double turn_acceleration = 4.0;  // [rad/s^2]
  double turn_jerk = 40.0;         // [rad/s^3]
  double pose_gain = 20.0;         // takes away what the end effector is off its way [1/s]
  double pose_error_max = 0.02;    // further off, and the motion is refused [m]
};

struct ServoConfig {
  model::ArmModel arm;
  model::Pose X_EC;  // the camera in the hand
  features::TargetFeature feature;
  bool auto_track = false;  // servo.auto_track: go to Track as soon as the target is known
  PredictConfig predict;
  LawConfig law;
  MoveConfig move;
  MotionLawConfig motion_law;
  GuardConfig guard;
  SafetyConfig safety;
};

}  // namespace fovea::config
