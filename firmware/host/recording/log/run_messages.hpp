// SPDX-License-Identifier: Apache-2.0
// Messages beside those of the ticks: a run's setup and the durations of its ticks, once in a log, and the
// truth.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/arm_model.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::log {

class Setup;
class TickTimes;
class Truth;
struct TruthSample;

// See Setup in firmware/host/recording/log/proto/fovea/run.proto.
struct RunSetup {
  std::string name;
  std::vector<std::string> joint_names;  // [arm.num_joints]
  model::ArmModel arm;
  features::TargetFeature feature;
  vision::Intrinsics intrinsics;
  double lambda = 0.0;         // [1/s]
  double target_radius = 0.0;  // of the sphere that encloses the target [m]; 0: there is no camera
  bool target_moves = false;
  double workspace_radius = 0.0;  // [m]
  double duration_s = 0.0;        // 0: until somebody ends the run
  std::int64_t start_ns = 0;      // the loop's clock when the run began
};

Setup SetupMessage(const RunSetup& setup);
TickTimes TickTimesMessage(const linux_rt::DurationHistogram& ticks);
Truth TruthMessage(const TruthSample& sample);

}  // namespace fovea::log
