// SPDX-License-Identifier: Apache-2.0
// Injects wrong measurements between the detector and the servo.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/feature.hpp"
#include "sim/faults/fault_fields.hpp"
#include "sim/faults/shared_faults.hpp"

namespace fovea::sim {

struct DetectorFaults {
  struct {
    TimeWindow window;
    double share = 1.0;                                  // share of wrong measurements
    std::array<double, hal::kMaxFeatureDim> shift{1.0};  // added to s, in its units
  } wrong;
  TimeWindow not_a_number;  // s[0] is NaN
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<DetectorFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  constexpr const char* kInstead = "the client runs the detector";
  v.Window({"wrong_detection", "s", "the detector is wrong about where the target is"}, f.wrong.window,
           kInstead);
  v.Number({"wrong_detection", "", "share of the measurements that are wrong, by chance"}, f.wrong.share, 0.0,
           1.0);
  v.List({"wrong_detection_shift", "units of s",
          "shift of s, one number per entry; a sphere's s is its centre in radii"},
         f.wrong.shift, hal::kMaxFeatureDim, -1e6, 1e6);
  v.Window({"nan_detection", "s", "the detector reports NaN"}, f.not_a_number, kInstead);
}

class FaultyDetector final : public hal::FeatureSink {
 public:
  // `sink` receives the measurements. It is borrowed.
  FaultyDetector(hal::FeatureSink& sink, const DetectorFaults& faults) : sink_(sink), faults_(faults) {}
  void Put(const hal::FeatureMeasurement& measurement) noexcept override;

  // Changes the faults from the next measurement on, except their seed. From any thread.
  void SetFaults(const DetectorFaults& faults);

 private:
  hal::FeatureSink& sink_;
  SharedFaults<DetectorFaults> faults_;
};

}  // namespace fovea::sim
