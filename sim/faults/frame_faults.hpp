// What goes wrong with frames between the lens and the computer: lost, old ones, late, wrongly stamped.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "sim/faults/time_window.hpp"
#include "sim/render/exposure.hpp"

namespace fovea::sim {

struct FrameFaults {
  struct {
    TimeWindow window;
    double share = 0.5;  // of the frames that are lost
  } loss;
  TimeWindow freeze;           // the first scene of the window again and again, with new stamps and new noise
  bool freeze_pixels = false;  // and then with the noise that it had: the very same picture
  struct {
    TimeWindow window;
    std::int64_t delay_ns = 0;
  } replay;  // the scene as it was so long ago, with new stamps; the first scene where there is none so old
  struct {
    TimeWindow window;
    std::int64_t by_ns = 0;
  } stamp;  // the stamps are off by this; the frames come when they would
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
  // By how much longer the frame exposed at `stamp_ns` takes.
  [[nodiscard]] std::int64_t DelayNs(std::int64_t stamp_ns) const;

 private:
  const Exposure& SceneFor(const Exposure& exposure);

  const FrameFaults faults_;
  std::deque<Exposure> past_;  // what may be replayed, oldest first
  std::optional<Exposure> frozen_;
};

}  // namespace fovea::sim
