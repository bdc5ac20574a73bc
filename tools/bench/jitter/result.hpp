// What `fovea-bench jitter` measured, before anybody wrote it down.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/common/figure.hpp"
#include "tools/bench/common/machine.hpp"
#include "tools/bench/common/spread.hpp"
#include "tools/bench/jitter/timed_loop.hpp"

namespace fovea::bench {

inline constexpr double kGoalRatio = 1.1;  // of the servo's p99.9 wake-up latency to cyclictest's

// Durations of one kind [us].
struct Durations {
  std::string name;   // of its figures
  std::string title;  // for people
  std::vector<double> us;
};

// A ratio of the servo's p99.9 wake-up latency.
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
  std::vector<std::vector<double>> cyclictest;  // latencies of each block [us]; empty: not there
  std::string cyclictest_absent;                // why
  std::vector<HopTimes> pictures;
};

// Servo, sleeper and cyclictest: wake-up; of the servo off-period, execution and response too.
std::vector<Durations> LoopDurations(const JitterResult& result);
// The stages of the servo's tick.
std::vector<Durations> StageDurations(const JitterResult& result);
// From picture to torque, hop by hop, and as a whole at the end; of the pictures that a tick used.
std::vector<Durations> HopDurations(const JitterResult& result);

std::vector<WakeRatio> WakeRatios(const JitterResult& result);

// Sums over the servo's blocks.
struct JitterCounts {
  std::string name;
  Block sum;  // without periods
};
std::vector<JitterCounts> CountsOf(const JitterResult& result);

// One sentence, and whether it is a good one.
struct JitterVerdict {
  bool holds = false;
  std::string words;
};
JitterVerdict Judge(const JitterResult& result);

// As figures with stable names, as text for a terminal, and as a page that needs nothing but `style`.
std::vector<Figure> JitterFigures(const JitterResult& result);
std::string JitterText(const JitterResult& result);
std::string JitterPage(const JitterResult& result, const std::string& style);
// As a timeline for ui.perfetto.dev or chrome://tracing. std::runtime_error when the file cannot be written.
void WriteJitterTrace(const JitterResult& result, const std::string& file);

}  // namespace fovea::bench
