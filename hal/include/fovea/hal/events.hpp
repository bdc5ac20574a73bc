// SPDX-License-Identifier: Apache-2.0
// Modes, faults and limits of the servo, by name, for logs, reports and other computers.
#pragma once

#include <cstdint>

namespace fovea::hal {

enum class Mode : std::uint8_t {
  kBoot,   // holds the arm where it was found, until it is sound and at rest
  kHold,   // holds the present position
  kTrack,  // follows the target that the camera sees
  kCoast,  // follows the target's prediction while the camera does not see it
  kFault,  // latched: damped stop, then brakes; left only by a reset
  kMove,   // follows a commanded motion: a goal, or a stream of setpoints
};
inline constexpr int kNumModes = 6;

// Why the servo is in Hold rather than in Track.
enum class HoldReason : std::uint8_t {
  kNone,             // not in Hold
  kNotAsked,         // Track was not requested
  kNoTarget,         // Track is requested, but no confident feature has arrived yet
  kTargetLost,       // the target was not seen for longer than servo.coast_s
  kGoalUnreachable,  // limits kept the arm from the goal for longer than servo.unreachable_s
  kMotionDone,       // the commanded motion has ended
  kMotionRefused,    // the commanded motion would exceed a limit, or is invalid
  kEyeDoubted,       // the picture contradicts the hand's motion, or following it fails: request Track again
  kNotFollowed,      // the arm deviated from the commanded motion by more than safety.motion_error
};
inline constexpr int kNumHoldReasons = 9;

// The cause of a fault; the first one is latched.
enum class Fault : std::uint8_t {
  kNone,
  kArmLost,           // the arm returned errors, or nothing, for too long
  kArmStale,          // the arm's stamps stand still or go back, or a joint's encoder hangs
  kNonFiniteSensor,   // a joint value stayed non-finite for too long
  kNonFiniteFeature,  // the vision task delivered a value that is not finite
  kNonFiniteControl,  // the control law produced a value that is not finite
  kDeadlineMissed,    // too many ticks in a row were missed
  kJointPosition,     // a joint was measured outside its range
  kJointVelocity,     // a joint's measured velocity exceeds its limit
  kNotFollowing,      // a joint does not follow its reference
  kContact,           // an external force on the arm exceeds its limit
};
inline constexpr int kNumFaults = 11;

// What the servo did with a measurement of the vision task.
enum class Intake : std::uint8_t {
  kNone,          // none arrived in this tick
  kTaken,         // used for the estimate
  kNotFound,      // the target is not in the picture
  kWrongKind,     // it is of another target, or has no position in front of the camera
  kFromFuture,    // its stamp is later than now
  kTooOld,        // its stamp is older than the joints' history, or than the measurement before
  kStuckPicture,  // the picture stayed the same although the hand moved the scene in it
  kOutOfRegion,   // the target would be outside servo.target_region
  kOutlier,       // too far from where the target is expected
};
inline constexpr int kNumIntakes = 9;

// How the arm goes to the target.
enum class Way : std::uint8_t {
  kLaw,        // by the visual law
  kAwaitPlan,  // it stops, and stands until a plan comes
  kPlan,       // along a plan
};
inline constexpr int kNumWays = 3;

// What happened to a plan in a tick.
enum class PlanEvent : std::uint8_t {
  kNone,
  kAsked,        // the arm stands, and a plan is asked for from its reference
  kTaken,        // a plan came, and the arm follows it
  kNoMotion,     // the planner found none: the law goes on alone
  kStale,        // a plan came that is not for this start and target: it is refused
  kLate,         // none came in time: the law goes on alone
  kHeld,         // limits held the arm up on its plan: a new one is asked for
  kTargetMoved,  // the target is elsewhere than planned: a new one is asked for
  kDone,         // the plan's end is reached: the law goes on
};
inline constexpr int kNumPlanEvents = 9;

// The answer to a request to change a key in motion.
enum class TuningResult : std::uint8_t {
  kNone,        // no request in this tick
  kTaken,       // the key moves to the new value
  kUnknownKey,  // no key that may change in motion has this number
  kNotFinite,
  kOutOfRange,    // outside the key's range
  kInconsistent,  // the key would contradict another key
};
inline constexpr int kNumTuningResults = 6;

// Limits that shape the motion or the torque. An active limit is reported; it is not a fault.
enum class Limit : std::uint8_t {
  kJointPosition,
  kJointVelocity,
  kJointAcceleration,
  kJointJerk,
  kWorkspace,
  kTorque,
  kTorqueRate,
  kObstacle,        // a plane or a box that the end effector must not enter
  kCartesianSpeed,  // of the end effector
  kSingularity,     // a posture in which the end effector loses a direction of motion
  kFieldOfView,     // the target at the edge of the picture
  kRotationSpeed,   // of the end effector
};
inline constexpr int kNumLimits = 12;

// One bit per Limit: those that were active in a tick.
using LimitSet = std::uint32_t;
constexpr LimitSet Bit(Limit limit) noexcept { return LimitSet{1} << static_cast<unsigned>(limit); }

// Names as in logs and summaries, e.g. "joint_position"; static storage.
const char* Name(Mode mode) noexcept;
const char* Name(HoldReason reason) noexcept;
const char* Name(Fault fault) noexcept;
const char* Name(Limit limit) noexcept;
const char* Name(Intake intake) noexcept;
const char* Name(TuningResult result) noexcept;
const char* Name(Way way) noexcept;
const char* Name(PlanEvent event) noexcept;

// The same for a person, e.g. "the target was lost"; static storage. An intake's words describe a
// measurement: "3 rejected as outlier".
const char* Words(HoldReason reason) noexcept;
const char* Words(Fault fault) noexcept;
const char* Words(Intake intake) noexcept;
const char* Words(TuningResult result) noexcept;
const char* Words(PlanEvent event) noexcept;

// The configuration key that sets the threshold, "" when none does; static storage.
const char* Key(Fault fault) noexcept;
const char* Key(Limit limit) noexcept;
const char* Key(Intake intake) noexcept;

}  // namespace fovea::hal
