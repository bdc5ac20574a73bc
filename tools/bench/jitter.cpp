#include "jitter.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "figure.hpp"
#include "fovea/config/input_error.hpp"
#include "fovea/config/program.hpp"
#include "fovea/config/share_folder.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/robots/robot.hpp"
#include "load.hpp"
#include "machine.hpp"
#include "spread.hpp"
#include "timed_loop.hpp"

namespace fovea::bench {
namespace {

constexpr int kBlockPeriods = 1000;  // of one kind, before the other has its turn
constexpr int kResamples = 1000;     // of the bootstrap
constexpr double kGoalRatio = 1.1;   // of the servo's p99.9 wake-up latency to the sleeper's

struct Measured {
  std::vector<Block> servo;
  std::vector<Block> sleeper;
};

std::vector<double> All(const std::vector<Block>& blocks, std::int32_t Period::*field) {
  std::vector<double> us;
  for (const Block& block : blocks) {
    for (const Period& period : block.periods) {
      us.push_back(1e-3 * period.*field);
    }
  }
  return us;
}

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

// The 90 % interval of the ratio of both p99.9, by drawing pairs of neighbouring blocks with replacement:
// what one disturbed minute did to both cancels.
Interval Bootstrap(const Measured& measured) {
  std::mt19937_64 engine(1);
  std::uniform_int_distribution<std::size_t> pick(0, measured.servo.size() - 1);
  std::vector<double> ratios;
  for (int k = 0; k < kResamples; ++k) {
    std::vector<double> servo;
    std::vector<double> sleeper;
    for (std::size_t i = 0; i < measured.servo.size(); ++i) {
      const std::size_t at = pick(engine);
      for (const Period& period : measured.servo[at].periods) {
        servo.push_back(period.wake_ns);
      }
      for (const Period& period : measured.sleeper[at].periods) {
        sleeper.push_back(period.wake_ns);
      }
    }
    ratios.push_back(Percentile(servo, 0.999) / Percentile(sleeper, 0.999));
  }
  return {Percentile(ratios, 0.05), Percentile(ratios, 0.95)};
}

void AddSpread(const std::string& name, const std::vector<double>& us, std::vector<Figure>& figures) {
  const std::vector<std::pair<const char*, double>> marks{{"min", 0.0},    {"p50", 0.5},      {"p99", 0.99},
                                                          {"p999", 0.999}, {"p9999", 0.9999}, {"max", 1.0}};
  for (const auto& [mark, p] : marks) {
    figures.push_back({fmt::format("{}_us_{}", name, mark), Percentile(us, p), "us", {}});
  }
}

void AddCounts(const std::string& name, const std::vector<Block>& blocks, std::vector<Figure>& figures) {
  Block sum;
  for (const Block& block : blocks) {
    sum.overruns += block.overruns;
    sum.page_faults += block.page_faults;
    sum.voluntary_switches += block.voluntary_switches;
    sum.involuntary_switches += block.involuntary_switches;
  }
  figures.push_back({name + "_overruns", static_cast<double>(sum.overruns), "", {}});
  figures.push_back({name + "_page_faults", static_cast<double>(sum.page_faults), "", {}});
  figures.push_back({name + "_voluntary_switches", static_cast<double>(sum.voluntary_switches), "", {}});
  figures.push_back({name + "_involuntary_switches", static_cast<double>(sum.involuntary_switches), "", {}});
}

// Counts per octave half, as bars whose length is the logarithm of the count.
void PrintHistogram(const std::vector<double>& servo, const std::vector<double>& sleeper) {
  const double most = std::max(Percentile(servo, 1.0), Percentile(sleeper, 1.0));
  fmt::print("\n  wake-up latency, counts   {:<32}{}\n", "servo #", "sleeper =");
  for (int half = 0; std::exp2(0.5 * (half - 1)) <= most; ++half) {
    const double low = half == 0 ? 0.0 : std::exp2(0.5 * half);
    const double high = std::exp2(0.5 * (half + 1));
    const auto count = [&](const std::vector<double>& us) {
      return std::count_if(us.begin(), us.end(), [&](double x) { return x >= low && x < high; });
    };
    const auto bar = [](long n, char mark) {
      return std::string(
          n == 0 ? 0U : 1U + static_cast<std::size_t>(4.0 * std::log10(static_cast<double>(n))), mark);
    };
    const long of_servo = count(servo);
    const long of_sleeper = count(sleeper);
    if (of_servo > 0 || of_sleeper > 0) {
      fmt::print("  {:>8.1f} to {:>8.1f} us  {:>7} {:<24}{:>7} {}\n", low, high, of_servo, bar(of_servo, '#'),
                 of_sleeper, bar(of_sleeper, '='));
    }
  }
}

void PrintSpread(const char* name, const std::vector<double>& us) {
  fmt::print("  {:<22}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}\n", name, Percentile(us, 0.0),
             Percentile(us, 0.5), Percentile(us, 0.99), Percentile(us, 0.999), Percentile(us, 0.9999),
             Percentile(us, 1.0));
}

void Say(int second, int seconds) {
  if (isatty(STDERR_FILENO) != 0) {
    fmt::print(stderr, "\r\x1b[K{}", second < seconds ? fmt::format("{} of {} s ...", second, seconds) : "");
    std::fflush(stderr);
  }
}

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
          fmt::format("--cpu {}: this machine has no such processor for us", arguments.cpu));
    }
  }
  return missing;
}

std::string Verdict(const std::vector<double>& response_us, std::uint64_t overruns) {
  const double worst = Percentile(response_us, 1.0);
  if (overruns == 0 && worst < 500.0) {
    return fmt::format("holds 1 kHz here: the worst response took {:.0f} us of 1000", worst);
  }
  if (overruns == 0) {
    return fmt::format("holds 1 kHz here, with little to spare: the worst response took {:.0f} us of 1000",
                       worst);
  }
  return fmt::format(
      "does NOT hold 1 kHz here: {} periods began a whole one late, the worst response took {:.0f} us",
      overruns, worst);
}

}  // namespace

int RunJitter(const JitterArguments& arguments) {
  const model::ArmModel arm = robots::LoadRobot(config::ShareFolder() / "robots" / "panda.toml").model;
  const std::vector<std::string> missing = PrepareThread(arguments);
  const MachineFacts machine = LookAtMachine(missing);
  Measured measured;
  {
    const Load load(arguments.load);
    RunServoBlock(arm, 100);  // warm
    for (int second = 0; second < arguments.seconds; ++second) {
      Say(second, arguments.seconds);
      measured.servo.push_back(RunServoBlock(arm, kBlockPeriods));
      measured.sleeper.push_back(RunSleepBlock(kBlockPeriods));
    }
    Say(arguments.seconds, arguments.seconds);
  }
  const std::vector<double> wake = All(measured.servo, &Period::wake_ns);
  const std::vector<double> execute = All(measured.servo, &Period::execute_ns);
  const std::vector<double> response = All(measured.servo, &Period::response_ns);
  const std::vector<double> sleeper = All(measured.sleeper, &Period::wake_ns);
  const double ratio = Percentile(wake, 0.999) / Percentile(sleeper, 0.999);
  const Interval interval = Bootstrap(measured);

  std::vector<Figure> figures;
  AddSpread("wake", wake, figures);
  AddSpread("execute", execute, figures);
  AddSpread("response", response, figures);
  AddSpread("sleeper_wake", sleeper, figures);
  figures.push_back({"wake_ratio_p999", ratio, "", kGoalRatio});
  figures.push_back({"wake_ratio_p999_low", interval.low, "", {}});
  figures.push_back({"wake_ratio_p999_high", interval.high, "", {}});
  AddCounts("servo", measured.servo, figures);
  AddCounts("sleeper", measured.sleeper, figures);
  if (arguments.json) {
    fmt::print("{}\n", ToJson(figures));
    return config::kDone;
  }
  std::uint64_t overruns = 0;
  for (const Block& block : measured.servo) {
    overruns += block.overruns;
  }
  fmt::print("  {}, {} cores, {}; load {}, policy {}\n\n", machine.kernel, machine.cores, machine.processor,
             arguments.load, arguments.policy);
  fmt::print("  {:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "us", "min", "p50", "p99", "p99.9", "p99.99", "max");
  PrintSpread("servo: wake-up", wake);
  PrintSpread("servo: execution", execute);
  PrintSpread("servo: response", response);
  PrintSpread("sleeper: wake-up", sleeper);
  PrintHistogram(wake, sleeper);
  fmt::print(
      "\n  p99.9 of the servo's wake-up is {:.2f} times the sleeper's (90 %: {:.2f} to {:.2f}; goal {:g})\n",
      ratio, interval.low, interval.high, kGoalRatio);
  fmt::print("  {}\n", Verdict(response, overruns));
  for (const std::string& limit : machine.limits) {
    fmt::print("  - {}\n", limit);
  }
  return config::kDone;
}

}  // namespace fovea::bench
