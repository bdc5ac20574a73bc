// A detector that now and then says what is not there: its measurements on their way to the servo.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/feature.hpp"
#include "sim/faults/time_window.hpp"

namespace fovea::sim {

struct DetectorFaults {
  struct {
    TimeWindow window;
    double share = 1.0;                               // of the measurements that are wrong
    std::array<double, hal::kMaxFeatureDim> shift{};  // added to s, in its units
  } wrong;
  TimeWindow not_a_number;  // s[0] is none
  std::uint64_t seed = 1;
};

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
