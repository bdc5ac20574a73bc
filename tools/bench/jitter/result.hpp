// SPDX-License-Identifier: Apache-2.0
// The result of `fovea-bench jitter`, and its forms: figures, text, page and timeline.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/common/figure.hpp"
#include "tools/bench/common/machine.hpp"
#include "tools/bench/common/spread.hpp"
#include "tools/bench/jitter/timed_loop.hpp"

namespace fovea::bench {

inline constexpr double kGoalRatio = 1.1;  // p99.9 wake-up latency of the servo divided by cyclictest's

// Durations of one kind [us].
struct Durations {
  std::string name;   // prefix of the figures' names
  std::string title;  // for text and page
  std::vector<double> us;
};

// The servo's p99.9 wake-up latency divided by that of `to`.
struct WakeRatio {
  std::string to;  // "the sleeping thread", "cyclictest"
  Ratio ratio;
};

struct JitterResult {
  MachineFacts machine;
  std::string load;
  std::string policy;
  int seconds = 0;
  std::vector<Block> servo;
  std::vector<Block> sleeper;
  std::vector<std::vector<double>> cyclictest;  // latencies of each block [us]; empty: no result
  std::string cyclictest_absent;                // why there is no result
  std::vector<HopTimes> pictures;
};

// Wake-up of servo, sleeper and cyclictest; period error, execution and response of the servo.
std::vector<Durations> LoopDurations(const JitterResult& result);
// The stages of the servo's tick.
std::vector<Durations> StageDurations(const JitterResult& result);
// From picture to torque: each hop, and last the whole way. Only pictures that a tick used.
std::vector<Durations> HopDurations(const JitterResult& result);

std::vector<WakeRatio> WakeRatios(const JitterResult& result);

// Sums over the blocks of servo or sleeper.
struct JitterCounts {
  std::string name;
  Block sum;  // without periods
};
std::vector<JitterCounts> CountsOf(const JitterResult& result);

// Whether the machine keeps 1 kHz, and a sentence that says so.
struct JitterVerdict {
  bool holds = false;
  std::string words;
};
JitterVerdict Judge(const JitterResult& result);

// The result as figures with stable names, as text for a terminal, and as an HTML page with the CSS `style`.
std::vector<Figure> JitterFigures(const JitterResult& result);
std::string JitterText(const JitterResult& result);
std::string JitterPage(const JitterResult& result, const std::string& style);
// Writes a timeline for ui.perfetto.dev or chrome://tracing. std::runtime_error when `file` is not writable.
void WriteJitterTrace(const JitterResult& result, const std::string& file);

}  // namespace fovea::bench
