// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/jitter/jitter.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/report/page_style.hpp"
#include "firmware/host/robots/robot.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "tools/bench/jitter/cyclictest.hpp"
#include "tools/bench/jitter/load.hpp"
#include "tools/bench/jitter/result.hpp"
#include "tools/bench/tick/model_arm.hpp"

namespace fovea::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kBlockPeriods = 1000;  // of one kind before the next kind's turn
constexpr int kPicturesPerS = 31;

void Say(int second, int seconds) {
  if (isatty(STDERR_FILENO) != 0) {
    fmt::print(stderr, "\r\x1b[K{}", second < seconds ? fmt::format("{} of {} s ...", second, seconds) : "");
    std::fflush(stderr);
  }
}

// Sets the thread's policy and processor. Returns the privileges that are missing.
std::vector<std::string> PrepareThread(const JitterArguments& arguments) {
  std::vector<std::string> missing;
  if (arguments.policy == "fifo") {
    missing = linux_rt::MakeThreadRealtime({});
  }
  if (arguments.cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(arguments.cpu), &set);
    if (sched_setaffinity(0, sizeof(set), &set) != 0) {
      throw config::InputError(
          fmt::format("--cpu {}: this machine has no such processor, or we may not use it", arguments.cpu));
    }
  }
  return missing;
}

// Measures one block of each kind in turns, all with the same camera and the same load.
void Measure(const JitterArguments& arguments, EyeChain& eye, const config::ServoConfig& config,
             JitterResult& result) {
  bool has_cyclictest = HasCyclictest();
  result.cyclictest_absent = has_cyclictest ? "" : "not installed (Debian's package rt-tests)";
  RunServoBlock(config, eye, 100);  // warm
  for (int second = 0; second < arguments.seconds; ++second) {
    Say(second, arguments.seconds);
    result.servo.push_back(RunServoBlock(config, eye, kBlockPeriods));
    result.sleeper.push_back(RunSleepBlock(kBlockPeriods));
    if (has_cyclictest) {
      const auto us = RunCyclictest(kBlockPeriods, arguments.policy, arguments.cpu);
      has_cyclictest = us.has_value();
      if (us) {
        result.cyclictest.push_back(*us);
      } else {
        result.cyclictest.clear();
        result.cyclictest_absent = "failed on this machine";
      }
    }
  }
  Say(arguments.seconds, arguments.seconds);
}

void WriteFiles(const fs::path& folder, const JitterResult& result) {
  const std::string style = report::PageStyle(config::ShareFolder() / "report");
  std::error_code error;
  fs::create_directories(folder, error);
  std::ofstream page(folder / "jitter.html");
  page << JitterPage(result, style);
  std::ofstream figures(folder / "jitter.json");
  figures << ToJson(JitterFigures(result)) << "\n";
  if (!page.flush() || !figures.flush()) {
    throw config::InputError(fmt::format("--out {}: cannot write to this folder", folder.string()));
  }
}

}  // namespace

int RunJitter(const JitterArguments& arguments) {
  const config::ServoConfig config =
      DefaultConfig(robots::LoadRobot(config::ShareFolder() / "robots" / "panda.toml").model);
  JitterResult result;
  result.load = arguments.load;
  result.policy = arguments.policy;
  result.seconds = arguments.seconds;
  // Enough for the three kinds and for starting them.
  EyeChain eye(config, static_cast<std::size_t>(kPicturesPerS * (4 * arguments.seconds + 10)));
  const ProcessorTime time;
  {
    const Load load(arguments.load);
    eye.Start();  // first, or the new thread would inherit this thread's policy and processor
    const std::vector<std::string> missing = PrepareThread(arguments);
    result.machine = LookAtMachine(missing, arguments.policy == "fifo");
    Measure(arguments, eye, config, result);
    eye.Stop();
    load.Check();
    for (std::string& words : InWords(time.SinceStart())) {
      result.machine.limits.push_back(std::move(words));
    }
  }
  result.pictures = eye.Hops();
  WriteFiles(arguments.out, result);
  if (!arguments.trace.empty()) {
    WriteJitterTrace(result, arguments.trace);
  }
  if (arguments.json) {
    fmt::print("{}\n", ToJson(JitterFigures(result)));
  } else {
    fmt::print("{}  {:<28}{}\n", JitterText(result), "page",
               (fs::path(arguments.out) / "jitter.html").string());
  }
  return config::kDone;
}

}  // namespace fovea::bench
