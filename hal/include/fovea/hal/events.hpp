// Modes, faults and limits of the servo, by name: what a log, a report or another computer must understand.
#pragma once

#include <cstdint>

namespace fovea::hal {

enum class Mode : std::uint8_t {
  kBoot,   // holding the arm where it was found, until it is sound and at rest
  kHold,   // standing where it stands
  kTrack,  // steering by the target as the camera sees it
  kCoast,  // steering by the target's prediction, since the camera does not see it
  kFault,  // latched: damped stop, then brakes; left only by a reset
  kMove,   // following a motion that was commanded: a goal, or a stream of setpoints
};
inline constexpr int kNumModes = 6;

// Why the servo is in Hold rather than in Track.
enum class HoldReason : std::uint8_t {
  kNone,             // not in Hold
  kNotAsked,         // nobody asked for Track
  kNoTarget,         // Track is asked for, no confident feature came yet
  kTargetLost,       // the target was not seen for longer than servo.coast_s
  kGoalUnreachable,  // limits kept the arm from the goal for longer than servo.unreachable_s
  kMotionDone,       // the commanded motion came to its end
  kMotionRefused,    // the commanded motion would have passed a limit, or was none
  kEyeDoubted,       // the picture moves against the hand, or steering by it does not help: ask anew
  kNotFollowed,      // the arm was off the commanded motion by more than safety.motion_error
};

// Causes of a fault, latched at the first.
enum class Fault : std::uint8_t {
  kNone,
  kArmLost,           // the arm answered with an error, or not at all, for too long
  kArmStale,          // the arm's stamps stand still or go back, or a joint's encoder hangs
  kNonFiniteSensor,   // a joint value stayed non-finite for too long
  kNonFiniteFeature,  // the vision task delivered a value that is not finite
  kNonFiniteControl,  // the control law produced a value that is not finite
  kDeadlineMissed,    // too many ticks in a row were missed
  kJointPosition,     // a joint was measured outside its range
  kJointVelocity,     // a joint was measured faster than it may be
  kNotFollowing,      // a joint does not follow its reference
  kContact,           // something pushes the arm harder than it may
};
inline constexpr int kNumFaults = 11;

// What became of a measurement that the vision task handed over.
enum class Intake : std::uint8_t {
  kNone,          // none came in this tick
  kTaken,         // it went into the estimate
  kNotFound,      // the target is not in the picture
  kWrongKind,     // it is of another target, or names no place before the camera
  kFromFuture,    // its stamp is later than now
  kTooOld,        // its stamp is older than the joints' history, or than the measurement before
  kStuckPicture,  // the picture stayed the same although the hand moved the scene in it
  kOutOfRegion,   // the target would be where it cannot be
  kOutlier,       // too far from where the target is expected
};
inline constexpr int kNumIntakes = 9;

// Limits that shape the motion or the torque. A limit that acts is no fault: it is reported.
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
  kSingularity,     // a posture in which a direction of the end effector is lost
  kFieldOfView,     // the target at the edge of the picture
  kRotationSpeed,   // of the end effector
};
inline constexpr int kNumLimits = 12;

// One bit per Limit: those which acted in a tick.
using LimitSet = std::uint32_t;
constexpr LimitSet Bit(Limit limit) noexcept { return LimitSet{1} << static_cast<unsigned>(limit); }

// Names as they stand in logs and summaries, e.g. "joint_position"; static storage.
const char* Name(Mode mode) noexcept;
const char* Name(HoldReason reason) noexcept;
const char* Name(Fault fault) noexcept;
const char* Name(Limit limit) noexcept;
const char* Name(Intake intake) noexcept;

// The configuration key that sets the threshold, "" when none does; static storage.
const char* Key(Fault fault) noexcept;
const char* Key(Limit limit) noexcept;
const char* Key(Intake intake) noexcept;

}  // namespace fovea::hal
