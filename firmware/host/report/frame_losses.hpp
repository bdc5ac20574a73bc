// SPDX-License-Identifier: Apache-2.0
// Counts frames that never reached the servo (gaps in the sequence numbers) and frames without target.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/host/report/run_data.hpp"
#include "fovea/tick.pb.h"

namespace fovea::report {

class FrameLosses {
 public:
  explicit FrameLosses(RunData& run) : run_(run) {}

  // In the order in which the servo took them. `t_s`: mid-exposure.
  void Add(const log::Feature& feature, double t_s) {
    ++run_.frames_taken;
    const std::uint64_t sequence = feature.sequence();
    if (run_.frames_taken > 1 && sequence > sequence_ && sequence - sequence_ > 1) {
      Put(run_.lost, {t_s_, t_s, sequence - sequence_ - 1});
    }
    // A span without target lasts until the next frame with the target.
    if (run_.frames_taken > 1 && !found_) {
      run_.not_found.back().to_s = t_s;
    }
    if (!feature.found()) {
      if (found_) {
        Put(run_.not_found, {t_s, t_s, 0});
      }
      ++run_.not_found.back().frames;
    }
    found_ = feature.found();
    sequence_ = sequence;
    t_s_ = t_s;
  }

 private:
  static constexpr std::size_t kMostSpans = 2000;  // later spans extend the last one

  static void Put(std::vector<FrameSpan>& spans, const FrameSpan& span) {
    if (spans.size() < kMostSpans) {
      spans.push_back(span);
    } else {
      spans.back().to_s = span.to_s;
      spans.back().frames += span.frames;
    }
  }

  RunData& run_;
  bool found_ = true;  // of the previous frame, like the two below
  std::uint64_t sequence_ = 0;
  double t_s_ = 0.0;
};

}  // namespace fovea::report
