// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/flight_recorder.hpp"

namespace fovea::flight {
namespace {

constexpr std::size_t kKeyframes = 8;  // room of the ring

// Copies the motion's numbers only if there is a motion.
template <class From>
void TakeDemand(const From& from, link::Demand& to) noexcept {
  to.request = from.request;
  if (from.motion.kind == moves::MotionKind::kNone) {
    to.motion.kind = moves::MotionKind::kNone;
  } else {
    to.motion = from.motion;
  }
  to.change_law = from.change_law;
  to.law = from.law;
  to.tuning = from.tuning;
  if (from.plan.IsThere()) {
    to.plan = from.plan;
  } else {
    to.plan.count = -1;
  }
}

}  // namespace

FlightRecorder::FlightRecorder(task::ServoStep& step, const task::ServoTask* task, std::size_t capacity)
    : step_(step), task_(task), records_(capacity), keyframes_(task != nullptr ? kKeyframes : 1) {}

void FlightRecorder::Step(const task::ServoInputs& inputs, task::ServoOutputs& outputs) noexcept {
  demand_.arm_status = inputs.arm_status.code();
  TakeDemand(inputs, demand_);
  step_.Step(inputs, outputs);
}

// Runs after the tick's torques are sent, so that recording does not delay them.
void FlightRecorder::Record(const hal::TickRecord& record) noexcept {
  records_.Fill([&](FlightRecord& place) {
    place.record = record;
    place.demand.arm_status = demand_.arm_status;
    TakeDemand(demand_, place.demand);
    place.state_digest.reset();
    if (task_ != nullptr) {
      place.state_digest = link::DigestOf(task_->config(), task_->state(), record.has_feature);
    }
  });
  if (task_ != nullptr && task_->state().tick % kKeyframeTicks == 0) {
    keyframes_.Fill([this](Keyframe& keyframe) {
      keyframe.tick = task_->state().tick;
      keyframe.state = task_->state();
    });
  }
}

}  // namespace fovea::flight
