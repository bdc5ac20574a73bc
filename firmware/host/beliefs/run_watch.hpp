// SPDX-License-Identifier: Apache-2.0
// Finds out from a run's records which of its servo's beliefs are wrong. Beside the tick: records go in,
// nothing comes back to the servo.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/load.hpp"
#include "firmware/host/beliefs/belief.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::beliefs {

struct EyeEstimate;

// Configured values that the servo itself does not have. Without them, a sentence tells a difference only.
struct Configured {
  std::optional<double> latency_ms;
  std::optional<model::Load> load;                // already part of the servo's arm
  std::string latency_key = "camera.latency_ms";  // of this program
};

class RunWatch {
 public:
  RunWatch(const config::ServoConfig& config, const Configured& configured);
  ~RunWatch();
  RunWatch(const RunWatch&) = delete;
  RunWatch& operator=(const RunWatch&) = delete;

  // A tick's record, in their order.
  void Add(const hal::TickRecord& record);

  [[nodiscard]] Findings Finish() const;
  // The eye's part of it alone.
  [[nodiscard]] EyeEstimate Eye() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fovea::beliefs
