// What goes wrong with frames between the lens and the computer: lost, the same one again, late.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/faults/time_window.hpp"
#include "sim/render/exposure.hpp"

namespace fovea::sim {

struct FrameFaults {
  struct {
    TimeWindow window;
    double share = 0.5;  // of the frames that are lost
  } loss;
  TimeWindow freeze;  // the first scene of the window again and again, with new stamps
  struct {
    TimeWindow window;
    std::int64_t by_ns = 0;
  } late;
  std::uint64_t seed = 1;
};

// Sees the exposures in their order, in the thread that advances the world.
class FrameSpoiler {
 public:
  explicit FrameSpoiler(const FrameFaults& faults) : faults_(faults) {}

  // What the camera takes instead of `exposure`; nothing when the frame is lost.
  [[nodiscard]] std::optional<Exposure> Spoil(const Exposure& exposure);
  // By how much longer the frame stamped `stamp_ns` takes.
  [[nodiscard]] std::int64_t DelayNs(std::int64_t stamp_ns) const;

 private:
  const FrameFaults faults_;
  std::optional<Exposure> frozen_;
};

}  // namespace fovea::sim
