// SPDX-License-Identifier: Apache-2.0
// Faults of frames between lens and computer: lost, frozen, replayed, late or wrongly stamped frames.
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
    double share = 0.5;  // share of lost frames
  } loss;
  TimeWindow freeze;           // repeats the window's first scene, with new stamps and new noise
  bool freeze_pixels = false;  // a frozen scene also keeps its noise: all pixels stay equal
  struct {
    TimeWindow window;
    std::int64_t delay_ns = 1'000'000'000;
  } replay;  // the scene of `delay_ns` ago with new stamps; the first scene if none is that old
  struct {
    TimeWindow window;
    std::int64_t by_ns = 8'000'000;
  } stamp;  // offset of the stamps; the frames arrive at their usual time
  struct {
    TimeWindow window;
    std::int64_t by_ns = 100'000'000;
  } late;
  std::uint64_t seed = 1;
};

template <class Visitor, Struct<FrameFaults> Faults>
void Fields(Visitor& v, Faults& f) {
  v.Window({"frame_loss", "s", "frames get lost"}, f.loss.window);
  v.Number({"frame_loss", "", "share of lost frames, at random"}, f.loss.share, 0.0, 1.0);
  v.Window({"freeze", "s", "the camera shows the same scene again and again, with new stamps"}, f.freeze);
  v.Flag({"freeze_pixels", "", "true: frozen pictures have equal pixels; false: each has new noise"},
         f.freeze_pixels);
  v.Window({"replay", "s", "the camera shows the scene as it was before, with new stamps"}, f.replay.window);
  v.Scaled({"replay_delay_s", "s", "age of the replayed scene; the first scene if none is that old"},
           f.replay.delay_ns, kNsOfS, 0.0, 1e3);
  v.Window({"stamp", "s", "the frames' stamps have an offset; the frames arrive at their usual time"},
           f.stamp.window, "the client synchronises the clocks itself");
  v.Scaled({"stamp_ms", "ms", "offset of the stamps; positive: a frame seems newer than it is"},
           f.stamp.by_ns, kNsOfMs, -1e4, 1e4);
  v.Window({"latency", "s", "frames exposed in this time arrive later; the next frames wait for them"},
           f.late.window);
  v.Scaled({"latency_ms", "ms", "delay in addition to camera.latency_ms"}, f.late.by_ns, kNsOfMs, 0.0, 1e4);
}

// Gets the exposures in order, on the thread that advances the world.
class FrameSpoiler {
 public:
  explicit FrameSpoiler(const FrameFaults& faults) : faults_(faults) {}

  // Changes the faults from the next exposure on, except their seed.
  void SetFaults(const FrameFaults& faults);

  // The exposure that the camera takes instead of `exposure`; none if the frame is lost.
  [[nodiscard]] std::optional<Exposure> Spoil(const Exposure& exposure);
  // Additional delay of the frame exposed at `stamp_ns`.
  [[nodiscard]] std::int64_t DelayNs(std::int64_t stamp_ns) const;

 private:
  const Exposure& SceneFor(const Exposure& exposure);

  FrameFaults faults_;
  std::deque<Exposure> past_;  // scenes to replay, oldest first
  std::optional<Exposure> frozen_;
};

}  // namespace fovea::sim
