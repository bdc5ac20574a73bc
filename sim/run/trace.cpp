// SPDX-License-Identifier: Apache-2.0
#include "sim/run/trace.hpp"

#include <algorithm>
#include <fstream>
#include <memory>
#include <utility>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/recording/trace/tick_trace.hpp"

namespace fovea::sim {
namespace {

constexpr double kTickHz = 1000.0;
constexpr double kMostEvents = 8e6;  // per track: 320 MB
constexpr double kSpare = 1000.0;

std::size_t Room(double events) { return static_cast<std::size_t>(std::min(events + kSpare, kMostEvents)); }

}  // namespace

RunTrace::RunTrace(std::filesystem::path file, double duration_s, double camera_rate_hz, int renderers)
    : file_(std::move(file)) {
  if (!std::ofstream(file_)) {
    throw config::InputError("--trace " + file_.string() + ": cannot be written");
  }
  constexpr double kAroundTick = 3.0;        // world, records, wait for vision
  constexpr double kVisionPerPicture = 3.0;  // wait, detect, log; doubled below for waits without a picture
  constexpr double kPartsOfPicture = 8.0;
  const double pictures = duration_s * camera_rate_hz;
  const double per_tick = static_cast<double>(trace::kSpansPerTick) + kAroundTick;
  servo_ = &trace_.AddTrack("servo and world", Room(duration_s * kTickHz * per_tick + pictures));
  vision_ = &trace_.AddTrack("vision", Room(2.0 * kVisionPerPicture * pictures));
  for (int i = 0; i < renderers; ++i) {
    renderers_.push_back(&trace_.AddTrack("renderer " + std::to_string(i), Room(kPartsOfPicture * pictures)));
  }
}

std::string RunTrace::Write() const {
  try {
    trace_.Write(file_);
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

Painter RunTrace::Watched(Painter painter, Optics& optics, int renderer) {
  trace::Track& track = *renderers_[static_cast<std::size_t>(renderer)];
  const auto last_ns = std::make_shared<std::int64_t>(0);  // both functions run on the painter's thread
  optics.Watch([&track, last_ns](const char* part) {
    const std::int64_t now_ns = trace::NowNs();
    track.Add({part, *last_ns, now_ns, -1, trace::Flow::kNone});
    *last_ns = now_ns;
  });
  const auto draw = std::move(painter.draw);
  painter.draw = [&track, last_ns, draw](const Exposure& exposure, std::span<std::uint8_t> rgba) {
    const std::int64_t begin_ns = trace::NowNs();
    *last_ns = begin_ns;
    draw(exposure, rgba);
    *last_ns = trace::NowNs();
    track.Add(
        {"draw", begin_ns, *last_ns, static_cast<std::int64_t>(exposure.sequence), trace::Flow::kBegin});
  };
  painter.picture_done = [&track, last_ns] {
    track.Add({"sensor", *last_ns, trace::NowNs(), -1, trace::Flow::kNone});
  };
  return painter;
}

}  // namespace fovea::sim
