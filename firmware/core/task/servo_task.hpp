// The 1 kHz servo task: one call of Step turns what the arm and the camera said into joint torques.
//
// Step is a function of (configuration, state, inputs): no clock, no globals. The same inputs give the same
// outputs to the last bit, in the simulator, on the robot, and in a replay.
#pragma once

#include <cmath>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/visual_law.hpp"
#include "firmware/core/control/way_to_goal.hpp"
#include "firmware/core/estimate/contact.hpp"
#include "firmware/core/estimate/encoder_watch.hpp"
#include "firmware/core/estimate/eye_watch.hpp"
#include "firmware/core/estimate/predict.hpp"
#include "firmware/core/features/feature_state.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/motion_laws/motion_law.hpp"
#include "firmware/core/moves/follow_motion.hpp"
#include "firmware/core/task/check_inputs.hpp"
#include "firmware/core/task/modes.hpp"
#include "firmware/core/task/stage_probe.hpp"
#include "fovea/hal/arm.hpp"
#include "fovea/hal/record.hpp"
#include "fovea/hal/status.hpp"

namespace fovea::task {

struct ServoInputs {
  hal::Status arm_status;  // of the read that gave `arm`
  hal::ArmState arm;
  bool has_feature = false;  // `feature` is new in this tick
  hal::FeatureMeasurement feature;
  Request request = Request::kNone;
  moves::MotionCommand motion;
  bool change_law = false;  // from now on `law`
  config::MotionLawKind law = config::MotionLawKind::kComputedTorque;
  std::int32_t missed_ticks = 0;  // deadlines missed since the tick before
};

// The record holds the command and all that led to it.
struct ServoOutputs {
  hal::TickRecord record;
  [[nodiscard]] const hal::ArmCommand& command() const noexcept { return record.command; }
};

// Intermediate terms, grouped by the stage that computes them; each is overwritten in its turn.
struct ServoState {
  std::uint64_t tick = 0;

  // check inputs
  std::int64_t now_ns = 0;  // the time for which this tick computes
  InputState inputs;
  model::VecN q;            // [num_joints] sound
  model::VecN dq;           // [num_joints] sound
  model::VecN tau_applied;  // [num_joints] sound

  // model
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::Pose X_BC;
  model::Mat6N J_C;
  model::LinearJacobian J_E_B;

  // contact
  estimate::ContactState contact;
  estimate::EncoderWatch encoders;
  bool blind = false;  // a joint's encoder hangs

  // predict
  hal::Intake intake = hal::Intake::kNone;  // of this tick's measurement
  estimate::PredictState predict;
  estimate::Prediction prediction;

  // modes
  estimate::EyeWatch eye;
  ModeState mode;
  std::int32_t fault_joint = -1;
  std::int64_t mode_since_ns = 0;
  std::int64_t track_since_ns = 0;  // the last entry into Track from Hold
  std::int64_t blocked_ns = 0;      // how much longer limits have kept the arm from the goal than not
  model::Vec3 p_BO_unreachable = model::Vec3::Zero();

  // visual law
  bool feature_valid = false;
  features::FeatureState feature;
  model::Mat3 R_BC_held = model::Mat3::Identity();  // the camera's when Track began
  control::VisualLawOutput law;
  control::WayToGoal way;  // of a target that is steered by in all six degrees of freedom

  // guard
  control::ResolvedMotion resolved;
  trajectory::Reference reference;
  bool holds = false;         // in Boot: the reference stands where the arm was found
  moves::MotionState motion;  // mode Move
  hal::LimitSet limits = 0;

  // motion law and clamp
  motion_laws::MotionLawState law_state;
  model::VecN tau;
  model::VecN tau_before;        // the command of the tick before
  double stop_speed = HUGE_VAL;  // in Fault: how slow the fastest joint should be by now [rad/s, m/s]
  bool give_up = false;          // in Fault: no torque any more
  bool braked = false;           // and the brakes, once it is gone
};

// One tick: here, or on another processor.
class ServoStep {
 public:
  // `outputs` is written whole. Real-time: yes, where it is computed.
  virtual void Step(const ServoInputs& inputs, ServoOutputs& outputs) noexcept = 0;

 protected:
  ~ServoStep() = default;
};

class ServoTask final : public ServoStep {
 public:
  // Checks `config` and takes it over. On kOutOfRange or kInvalidArgument, where() names the field.
  // Real-time: no.
  [[nodiscard]] hal::Status Init(const config::ServoConfig& config) noexcept;

  // One tick. `outputs` is written whole. Real-time: yes.
  void Step(const ServoInputs& inputs, ServoOutputs& outputs) noexcept override;

  // From now on told of each stage; null: nobody is. Real-time: yes.
  void UseProbe(StageProbe* probe) noexcept { probe_ = probe; }

  [[nodiscard]] const config::ServoConfig& config() const noexcept { return config_; }
  [[nodiscard]] const ServoState& state() const noexcept { return state_; }
  // After Init: goes on as the servo, of the same configuration, that left `state`. Real-time: no.
  void Restore(const ServoState& state) noexcept { state_ = state; }

 private:
  void CheckArm(const ServoInputs& inputs, InputCheck& check) noexcept;
  void ComputeModel() noexcept;
  void PredictFeature(const ServoInputs& inputs, hal::Fault& fault) noexcept;
  void ChooseMode(const ServoInputs& inputs, const InputCheck& check) noexcept;
  void ComputeVisualLaw() noexcept;
  [[nodiscard]] bool ComputeFeature() noexcept;
  void ChooseTheWay() noexcept;
  void MoveReference(const ServoInputs& inputs) noexcept;
  void CheckContact(std::int32_t missed_ticks, hal::Fault& fault, std::int32_t& joint) noexcept;
  [[nodiscard]] bool IsOutside() const noexcept;
  void ForgetMotion() noexcept;
  void CheckFollowing() noexcept;
  void UpdateBlockedTime() noexcept;
  void NoteSteering() noexcept;
  void ComputeTorque(const ServoInputs& inputs) noexcept;
  [[nodiscard]] bool CarriesLoads() const noexcept;
  [[nodiscard]] bool Stands() const noexcept;
  void StopDamped() noexcept;
  void Clamp() noexcept;
  void WriteRecord(const ServoInputs& inputs, hal::TickRecord& record) const noexcept;
  void LatchFault(hal::Fault fault, std::int32_t joint) noexcept;
  void MarkStageEnd(Stage stage) noexcept {
    if (probe_ != nullptr) {
      probe_->MarkStageEnd(stage);
    }
  }

  config::ServoConfig config_;
  features::FeatureState goal_;  // the feature at its goal
  ServoState state_;
  StageProbe* probe_ = nullptr;
};

}  // namespace fovea::task
