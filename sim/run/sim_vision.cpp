// SPDX-License-Identifier: Apache-2.0
#include "sim/run/sim_vision.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "firmware/host/recording/trace/vision_trace.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/fault_settings.hpp"

namespace fovea::sim {

SimVision::SimVision(const RunDescription& about, Observer observer)
    : about_(about),
      observer_(std::move(observer)),
      task_(config::MakeVisionConfig(about.scenario.vision, about.intrinsics, about.scenario.target)),
      detector_(delay_, Seeded(about.scenario.faults.detector,
                               SeedOf(about.scenario, RandomStream::kDetectorFaults))),
      frame_faults_(
          Seeded(about.scenario.faults.frames, SeedOf(about.scenario, RandomStream::kFrameFaults))) {}

SimVision::~SimVision() { End(); }

void SimVision::Open(const EyeOptions& options) {
  trace_ = options.trace;
  eye_.emplace(about_, options);
}

void SimVision::Begin() {
  thread_ = std::thread([this] { Run(); });
}

void SimVision::End() {
  if (thread_.joinable()) {
    eye_->camera().Close();
    thread_.join();
  }
}

void SimVision::Run() {
  linux_rt::MakeThreadYielding("fovea-vision");
  std::optional<trace::VisionTrace> traced;
  if (trace_ != nullptr) {
    traced.emplace(trace_->vision(), eye_->camera(), detector_);
  }
  try {
    const hal::Status status =
        vision::RunVision(traced ? static_cast<hal::Camera&>(*traced) : eye_->camera(), task_,
                          traced ? static_cast<hal::FeatureSink&>(*traced) : detector_, never_stop_,
                          [this](const hal::Frame& frame, const vision::Detection& detection) {
                            observer_(frame, detection, targets_.Take(frame.sequence));
                          });
    static_cast<void>(status);  // a normal end, or a fault whose message the camera keeps
  } catch (...) {
    failure_ = std::current_exception();
  }
  delay_.Close();
}

bool SimVision::Expose(const Exposure& exposure) {
  std::optional<Exposure> taken = frame_faults_.Spoil(exposure);
  if (!taken) {
    ++lost_on_purpose_;
    return false;
  }
  const std::int64_t mean_ns =
      exposure.stamp_ns + static_cast<std::int64_t>(about_.bench.camera.latency_ms * 1e6);
  arrived_ns_ = std::max(arrived_ns_, mean_ns + about_.stamps.JitterNs(exposure.sequence));
  taken->stamp_error_ns += about_.stamps.ErrorNs(arrived_ns_ - mean_ns, exposure.stamp_ns);
  targets_.Put(exposure.sequence,
               {exposure.X_BC.linear().transpose() * exposure.R_BO, exposure.X_BC.inverse() * exposure.p_BO});
  delay_.Expect(exposure.sequence, arrived_ns_ + frame_faults_.DelayNs(exposure.stamp_ns));
  eye_->camera().Expose(*std::move(taken));
  return true;
}

void SimVision::SetFaults(const FaultSettings& faults) {
  frame_faults_.SetFaults(faults.frames);
  detector_.SetFaults(faults.detector);
  if (eye_) {
    eye_->SetFaults(faults.picture);
  }
}

void SimVision::RethrowFailure() const {
  if (failure_) {
    std::rethrow_exception(failure_);
  }
  if (eye_ && !eye_->camera().fault().empty()) {
    throw std::runtime_error("the camera failed during the run: " + eye_->camera().fault());
  }
}

}  // namespace fovea::sim
