// SPDX-License-Identifier: Apache-2.0
// Automatic exposure: a gain that follows the brightness of the pictures, late.
//
// A picture of gain g and mean gray level m, as the sensor outputs it, asks for the gain g level / m. The
// gain approaches it with a time constant, in its logarithm. A picture is measured while the next one is
// exposed, so its brightness affects the second one after it. The exposure time stays: blur and stamps do not
// depend on the light.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace fovea::sim {

struct AutoExposureConfig {
  double level = 0.0;  // wanted mean of a picture [gray levels]; 0: the gain is 1
  double lag_s = 0.2;  // time constant
  double gain_max = 16.0;

  [[nodiscard]] bool IsOn() const { return level > 0.0; }
};

// What is measured of a picture.
struct Brightness {
  double mean = 0.0;  // of the sensor's output [gray levels]
  double gain = 1.0;  // that it was taken with
};

class AutoExposure {
 public:
  explicit AutoExposure(const AutoExposureConfig& config) : config_(config) {}

  // Picture `index` was exposed at `stamp_ns`; no brightness: it was lost. Indices count from 0 without a
  // gap, but their pictures may be measured in any order.
  void Measure(std::uint64_t index, std::int64_t stamp_ns, std::optional<Brightness> brightness);
  // The gain of picture `index`; none: the picture two before it is not measured yet. Call it once for each.
  [[nodiscard]] std::optional<double> TakeGain(std::uint64_t index);

 private:
  struct Measured {
    std::int64_t stamp_ns = 0;
    std::optional<Brightness> brightness;
  };
  static constexpr std::uint64_t kBehind = 2;
  static constexpr std::uint64_t kKept = 64;  // gains older than this were of lost pictures

  const AutoExposureConfig config_;
  std::map<std::uint64_t, Measured> waiting_;  // until all before them are measured
  std::map<std::uint64_t, double> gains_;      // that are known, and not taken
  std::uint64_t next_ = 0;                     // the first that is not measured
  std::int64_t last_ns_ = 0;
  double log_gain_ = 0.0;
};

}  // namespace fovea::sim
