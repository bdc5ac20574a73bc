// SPDX-License-Identifier: Apache-2.0
// The 1 kHz servo task: one call of Step converts the data of arm and camera to joint torques.
//
// Step is a function of (configuration, state, inputs): no clock, no globals. The same inputs give the same
// outputs to the last bit, in the simulator, on the robot, and in a replay.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/config/tuning.hpp"
#include "firmware/core/features/feature_state.hpp"
#include "firmware/core/guard/guard_motion.hpp"
#include "firmware/core/moves/follow_motion.hpp"
#include "firmware/core/task/check_inputs.hpp"
#include "firmware/core/task/modes.hpp"
#include "firmware/core/task/servo_state.hpp"
#include "firmware/core/task/stage_probe.hpp"
#include "firmware/core/trajectory/plan_part.hpp"
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
  bool change_law = false;  // change to `law`
  config::MotionLawKind law = config::MotionLawKind::kComputedTorque;
  config::Tuning tuning;          // change this key in motion
  trajectory::PlanPart plan;      // a part of the plan that the servo asked for
  std::int32_t missed_ticks = 0;  // deadlines missed since the previous tick
};

// The record holds the command and everything that led to it.
struct ServoOutputs {
  hal::TickRecord record;
  [[nodiscard]] const hal::ArmCommand& command() const noexcept { return record.command; }
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
  // Checks and stores `config`. On kOutOfRange or kInvalidArgument, where() names the field. Real-time: no.
  [[nodiscard]] hal::Status Init(const config::ServoConfig& config) noexcept;

  // One tick. `outputs` is written whole. Real-time: yes.
  void Step(const ServoInputs& inputs, ServoOutputs& outputs) noexcept override;

  // Sets the probe that is told of each stage; null: none. Real-time: yes.
  void UseProbe(StageProbe* probe) noexcept { probe_ = probe; }

  // As of the last tick: keys may change in motion.
  [[nodiscard]] const config::ServoConfig& config() const noexcept { return config_; }
  [[nodiscard]] const ServoState& state() const noexcept { return state_; }
  // After Init: continues from the `state` of a servo with the same configuration. Real-time: no.
  void Restore(const ServoState& state) noexcept {
    state_ = state;
    ApplyTunings(state_.tuning, config_);
  }

 private:
  void CheckArm(const ServoInputs& inputs, InputCheck& check) noexcept;
  void ComputeModel() noexcept;
  void WatchForContact(std::int32_t missed_ticks, InputCheck& check) noexcept;
  void PredictFeature(const ServoInputs& inputs, hal::Fault& fault) noexcept;
  void ChooseMode(const ServoInputs& inputs, const InputCheck& check) noexcept;
  void ComputeVisualLaw(const trajectory::PlanPart& plan) noexcept;
  [[nodiscard]] bool ComputeFeature() noexcept;
  void SwingAboutADisc() noexcept;
  void ChooseTheWay() noexcept;
  [[nodiscard]] bool IsPlanned() const noexcept;
  void TakePlan(const trajectory::PlanPart& part) noexcept;
  void MoveReference(const ServoInputs& inputs) noexcept;
  [[nodiscard]] bool ResolveWish(double slowing, guard::MotionWish& wish) noexcept;
  [[nodiscard]] bool IsOutside() const noexcept;
  void CheckFollowing() noexcept;
  void UpdateBlockedTime() noexcept;
  void NoteSteering() noexcept;
  void ComputeTorque(const ServoInputs& inputs) noexcept;
  [[nodiscard]] bool CarriesLoads() const noexcept;
  void HoldLoadOffset() noexcept;
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
  features::FeatureState goal_;                           // the feature at its goal
  std::array<bool, config::kNumMotionLaws> may_drive_{};  // laws that fit the arm and the gains
  ServoState state_;
  StageProbe* probe_ = nullptr;
};

}  // namespace fovea::task
