// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tick/tick.hpp"

#include <fmt/format.h>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/robots/robot.hpp"
#include "firmware/host/robots/shipped_robots.hpp"
#include "tools/bench/common/figure.hpp"
#include "tools/bench/common/spread.hpp"
#include "tools/bench/tick/feature_speed.hpp"
#include "tools/bench/tick/inputs.hpp"
#include "tools/bench/tick/instructions.hpp"
#include "tools/bench/tick/law_speed.hpp"
#include "tools/bench/tick/model_speed.hpp"

namespace fovea::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Ns = std::chrono::duration<double, std::nano>;

constexpr int kReplays = 7;                      // of each case; a tick's time is the least one
constexpr int kColdTicks = 300;                  // spread over the case
constexpr std::size_t kFlushBytes = 64U << 20U;  // larger than any cache
constexpr double kGoalNs = 5000.0;

void Start(const TickCase& c, task::ServoTask& task) {
  if (!task.Init(c.config).ok()) {
    throw std::logic_error("a configuration that was run is refused");
  }
}

// One tick of a case.
struct TimedTick {
  double ns = 0.0;
  hal::Mode mode = hal::Mode::kBoot;
};

std::vector<TimedTick> Replay(const TickCase& c) {
  std::vector<TimedTick> ticks(c.inputs.size());
  task::ServoOutputs outputs;
  for (int replay = 0; replay < kReplays; ++replay) {
    task::ServoTask task;
    Start(c, task);
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      const Clock::time_point begin = Clock::now();
      task.Step(c.inputs[k], outputs);
      const double ns = Ns(Clock::now() - begin).count();
      ticks[k].ns = replay == 0 ? ns : std::min(ticks[k].ns, ns);
      ticks[k].mode = outputs.record.mode;
    }
  }
  return ticks;
}

// Times of single ticks with flushed caches, about kColdTicks of them, spread over the case.
std::vector<double> ReplayCold(const TickCase& c) {
  std::vector<unsigned char> flush(kFlushBytes);
  std::vector<double> ns;
  task::ServoTask task;
  Start(c, task);
  task::ServoOutputs outputs;
  const std::size_t every = std::max<std::size_t>(c.inputs.size() / kColdTicks, 1);
  for (std::size_t k = 0; k < c.inputs.size(); ++k) {
    const bool cold = k % every == every - 1;
    if (cold) {
      for (std::size_t i = 0; i < flush.size(); i += 64) {
        ++flush[i];
      }
    }
    const Clock::time_point begin = Clock::now();
    task.Step(c.inputs[k], outputs);
    if (cold) {
      ns.push_back(Ns(Clock::now() - begin).count());
    }
  }
  return ns;
}

class StageTimer final : public task::StageProbe {
 public:
  void Begin() { last_ = Clock::now(); }
  void MarkStageEnd(task::Stage stage) noexcept override {
    const Clock::time_point now = Clock::now();
    ns_[static_cast<std::size_t>(stage)] = Ns(now - last_).count();
    last_ = now;
  }
  [[nodiscard]] const std::array<double, task::kStageNames.size()>& ns() const { return ns_; }

 private:
  Clock::time_point last_;
  std::array<double, task::kStageNames.size()> ns_{};
};

// Median time between two readings of the clock.
double ClockNs() {
  std::vector<double> ns;
  constexpr int kReadings = 1000;
  ns.reserve(kReadings);
  for (int i = 0; i < kReadings; ++i) {
    const Clock::time_point begin = Clock::now();
    ns.push_back(Ns(Clock::now() - begin).count());
  }
  return Percentile(ns, 0.5);
}

// Median time of each stage, minus the time of reading the clock.
std::vector<double> StageMedians(const TickCase& c) {
  task::ServoTask task;
  Start(c, task);
  StageTimer timer;
  task.UseProbe(&timer);
  std::array<std::vector<double>, task::kStageNames.size()> all;
  task::ServoOutputs outputs;
  for (const task::ServoInputs& inputs : c.inputs) {
    timer.Begin();
    task.Step(inputs, outputs);
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].push_back(timer.ns()[i]);
    }
  }
  const double clock = ClockNs();
  std::vector<double> medians;
  medians.reserve(all.size());
  for (const std::vector<double>& ns : all) {
    medians.push_back(std::max(Percentile(ns, 0.5) - clock, 0.0));
  }
  return medians;
}

std::vector<double> Times(const std::vector<TimedTick>& ticks) {
  std::vector<double> ns;
  ns.reserve(ticks.size());
  for (const TimedTick& tick : ticks) {
    ns.push_back(tick.ns);
  }
  return ns;
}

// Shows the progress on a terminal.
void Say(const char* what) {
  if (isatty(STDERR_FILENO) != 0) {
    fmt::print(stderr, "\r\x1b[K{}", what);
    std::fflush(stderr);
  }
}

void AddInstructions(const TickArguments& arguments, std::vector<Figure>& figures) {
  const std::vector<std::string> words{"tick", "--robot", arguments.robot, "--runs",
                                       std::to_string(std::min(arguments.runs, 2))};
  for (const char* mode : {"boot", "hold", "track", "coast", "move", "fault"}) {
    Say(fmt::format("counting instructions in mode {} ...", mode).c_str());
    if (const std::optional<double> count = CountInstructions(words, mode)) {
      figures.push_back({fmt::format("instructions_{}", mode), *count, "instructions", {}});
    }
  }
  for (const char* how : {"traced", "recorded"}) {
    std::vector<std::string> more = words;
    more.push_back(fmt::format("--{}", how));
    Say(fmt::format("counting instructions, {} ...", how).c_str());
    if (const std::optional<double> count = CountInstructions(more, "track")) {
      figures.push_back({fmt::format("instructions_track_{}", how), *count, "instructions", {}});
    }
  }
}

std::vector<TickCase> Cases(const model::ArmModel& arm, int runs) {
  std::vector<TickCase> cases{TrackingCase(arm), CommandedCase(arm), LossCase(arm)};
  for (int i = 0; i < runs; ++i) {
    Say(fmt::format("closing random loops, {} of {} ...", i + 1, runs).c_str());
    cases.push_back(RandomCase(arm, static_cast<unsigned>(i + 1)));
  }
  return cases;
}

void AddTicks(const std::vector<TickCase>& cases, std::vector<Figure>& figures) {
  std::map<hal::Mode, std::vector<double>> by_mode;
  std::vector<double> random;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Say(fmt::format("timing, {} of {} ...", i + 1, cases.size()).c_str());
    const TickCase& c = cases[i];
    const std::vector<TimedTick> ticks = Replay(c);
    const std::vector<double> ns = Times(ticks);
    for (const TimedTick& tick : ticks) {
      by_mode[tick.mode].push_back(tick.ns);
    }
    if (c.name == "tracking") {
      figures.push_back({"tick_ns_p50", Percentile(ns, 0.5), "ns", kGoalNs});
      figures.push_back({"tick_ns_p99", Percentile(ns, 0.99), "ns", {}});
      figures.push_back({"tick_ns_max", Percentile(ns, 1.0), "ns", {}});
      figures.push_back({"tick_cold_ns_p50", Percentile(ReplayCold(c), 0.5), "ns", {}});
      const std::vector<double> stages = StageMedians(c);
      for (std::size_t s = 0; s < stages.size(); ++s) {
        figures.push_back({fmt::format("stage_{}_ns", task::kStageNames[s]), stages[s], "ns", {}});
      }
    } else if (c.name == "commanded") {
      figures.push_back({"tick_commanded_ns_p50", Percentile(ns, 0.5), "ns", kGoalNs});
    } else if (c.name == "random") {
      random.insert(random.end(), ns.begin(), ns.end());
    }
  }
  if (!random.empty()) {
    figures.push_back({"tick_random_ns_p50", Percentile(random, 0.5), "ns", kGoalNs});
    figures.push_back({"tick_random_ns_min", Percentile(random, 0.0), "ns", {}});
    figures.push_back({"tick_random_ns_max", Percentile(random, 1.0), "ns", {}});
  }
  for (const auto& [mode, ns] : by_mode) {
    figures.push_back({fmt::format("tick_{}_ns_p50", hal::Name(mode)), Percentile(ns, 0.5), "ns", {}});
  }
}

}  // namespace

int RunTick(const TickArguments& arguments) {
  const model::ArmModel arm = robots::LoadRobot(robots::FindRobot(arguments.robot, "--robot")).model;
  if (arm.num_joints < 6) {
    throw config::InputError(
        fmt::format("--robot \"{}\": the arm must have at least six joints", arguments.robot));
  }
  const std::vector<TickCase> cases = Cases(arm, arguments.runs);
  if (!arguments.count.empty()) {
    RunCounted(cases, arguments.count, arguments.traced, arguments.recorded);
    return config::kDone;
  }
  std::vector<Figure> figures;
  AddTicks(cases, figures);
  Say("timing model and law ...");
  for (const auto& part : {LawSpeed(arm), FeatureSpeed(), ModelSpeed(arm)}) {
    figures.insert(figures.end(), part.begin(), part.end());
  }
  if (arguments.instructions) {
    AddInstructions(arguments, figures);
  }
  Say("");
  if (arguments.json) {
    fmt::print("{}\n", ToJson(figures));
  } else {
    fmt::print("{}", ToTable(figures));
  }
  return config::kDone;
}

}  // namespace fovea::bench
