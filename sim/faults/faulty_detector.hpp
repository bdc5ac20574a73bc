// A detector that now and then says what is not there: its measurements on their way to the servo.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/feature.hpp"
#include "sim/faults/fault_fields.hpp"

namespace fovea::sim {

struct DetectorFaults {
  struct {
    TimeWindow window;
    double share = 1.0;                                  // of the measurements that are wrong
    std::array<double, hal::kMaxFeatureDim> shift{1.0};  // added to s, in its units
  } wrong;
  TimeWindow not_a_number;  // s[0] is none
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<DetectorFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  constexpr const char* kInstead = "the detector is the client's";
  v.Window({"wrong_detection", "s", "the detector is wrong about where the target is"}, f.wrong.window,
           kInstead);
  v.Number({"wrong_detection", "", "share of the measurements that are wrong, by chance"}, f.wrong.share, 0.0,
           1.0);
  v.List({"wrong_detection_shift", "units of s",
          "by how much, entry by entry; a sphere's s is its centre in radii"},
         f.wrong.shift, hal::kMaxFeatureDim, -1e6, 1e6);
  v.Window({"nan_detection", "s", "the detector gives a value that is no number"}, f.not_a_number, kInstead);
}

class FaultyDetector final : public hal::FeatureSink {
 public:
  // `sink` is borrowed: where the measurements go on to.
  FaultyDetector(hal::FeatureSink& sink, const DetectorFaults& faults) : sink_(sink), faults_(faults) {}
  void Put(const hal::FeatureMeasurement& measurement) noexcept override;

 private:
  hal::FeatureSink& sink_;
  const DetectorFaults faults_;
};

}  // namespace fovea::sim
