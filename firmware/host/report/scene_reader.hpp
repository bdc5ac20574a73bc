// SPDX-License-Identifier: Apache-2.0
// Converts a log's scene and transforms to links with shapes, and their poses over time.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "firmware/host/report/run_data.hpp"
#include "fovea/run.pb.h"
#include "foxglove/geometry.pb.h"
#include "foxglove/scene.pb.h"

namespace fovea::report {

class SceneReader {
 public:
  explicit SceneReader(RunData& run) : run_(run) {}

  void AddScene(const foxglove::SceneUpdate& scene);
  void AddTransforms(const foxglove::FrameTransforms& transforms, double t_s);
  void AddTruth(const log::Truth& truth, double t_s);
  // Call after the last message: replaces the target's predicted poses by the true ones, if there are any.
  void Finish();

 private:
  void Thin();

  RunData& run_;
  std::map<std::string, std::size_t> link_of_frame_;
  std::int64_t frames_seen_ = 0;
  std::int64_t stride_ = 1;  // one of so many frames is kept
  std::vector<float> truth_t_s_;
  std::vector<float> truth_X_;  // x, y, z, qw, qx, qy, qz of the target in B
  std::int64_t truths_seen_ = 0;
  std::int64_t truth_stride_ = 1;
};

}  // namespace fovea::report
