// What goes wrong with frames between the lens and the computer: lost, old ones, late, wrongly stamped.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "sim/faults/fault_fields.hpp"
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
    std::int64_t delay_ns = 1'000'000'000;
  } replay;  // the scene as it was so long ago, with new stamps; the first scene where there is none so old
  struct {
    TimeWindow window;
    std::int64_t by_ns = 8'000'000;
  } stamp;  // the stamps are off by this; the frames come when they would
  struct {
    TimeWindow window;
    std::int64_t by_ns = 100'000'000;
  } late;
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<FrameFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  v.Window({"frame_loss", "s", "frames get lost from the first time to the second"}, f.loss.window);
  v.Number({"frame_loss", "", "share of them, by chance"}, f.loss.share, 0.0, 1.0);
  v.Window({"freeze", "s",
            "the camera shows the same scene again and again, with new stamps, from the first time to the "
            "second"},
           f.freeze);
  v.Flag({"freeze_pixels", "", "then all its pixels stay equal; false: each picture has noise of its own"},
         f.freeze_pixels);
  v.Window({"replay", "s", "the camera shows the scene as it was before, with new stamps"}, f.replay.window);
  v.Scaled({"replay_delay_s", "s", "so long before; the first scene where there is none so old"},
           f.replay.delay_ns, kNsOfS, 0.0, 1e3);
  v.Window({"stamp", "s", "the frames' stamps are off; the frames come when they would"}, f.stamp.window,
           "the client compares clocks itself");
  v.Scaled({"stamp_ms", "ms", "by so much; above 0 a frame says that it is younger than it is"},
           f.stamp.by_ns, kNsOfMs, -1e4, 1e4);
  v.Window({"latency", "s",
            "frames exposed from the first time to the second arrive later; those behind them wait"},
           f.late.window);
  v.Scaled({"latency_ms", "ms", "by so much, besides camera.latency_ms"}, f.late.by_ns, kNsOfMs, 0.0, 1e4);
}

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
