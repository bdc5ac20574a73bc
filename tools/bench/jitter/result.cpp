// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/jitter/result.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace fovea::bench {
namespace {

constexpr double kTail = 0.999;
constexpr std::array<std::pair<const char*, double>, 6> kMarks{
    {{"min", 0.0}, {"p50", 0.5}, {"p99", 0.99}, {"p999", 0.999}, {"p9999", 0.9999}, {"max", 1.0}}};

std::vector<double> All(const std::vector<Block>& blocks, std::int32_t Period::*field) {
  std::vector<double> us;
  for (const Block& block : blocks) {
    for (const Period& period : block.periods) {
      us.push_back(1e-3 * period.*field);
    }
  }
  return us;
}

std::vector<std::vector<double>> Wakes(const std::vector<Block>& blocks) {
  std::vector<std::vector<double>> wakes;
  for (const Block& block : blocks) {
    std::vector<double>& us = wakes.emplace_back();
    for (const Period& period : block.periods) {
      us.push_back(1e-3 * period.wake_ns);
    }
  }
  return wakes;
}

Block Sum(const std::vector<Block>& blocks) {
  Block sum;
  for (const Block& block : blocks) {
    sum.overruns += block.overruns;
    sum.fault_ticks += block.fault_ticks;
    sum.page_faults += block.page_faults;
    sum.voluntary_switches += block.voluntary_switches;
    sum.involuntary_switches += block.involuntary_switches;
  }
  return sum;
}

}  // namespace

std::vector<Durations> LoopDurations(const JitterResult& result) {
  std::vector<Durations> list;
  list.push_back({"wake", "servo: wake-up", All(result.servo, &Period::wake_ns)});
  list.push_back({"execute", "servo: execution", All(result.servo, &Period::execute_ns)});
  list.push_back({"off_period", "servo: period error", All(result.servo, &Period::off_period_ns)});
  list.push_back({"response", "servo: response", All(result.servo, &Period::response_ns)});
  list.push_back({"sleeper_wake", "sleeper: wake-up", All(result.sleeper, &Period::wake_ns)});
  if (!result.cyclictest.empty()) {
    Durations all{"cyclictest_wake", "cyclictest: wake-up", {}};
    for (const std::vector<double>& block : result.cyclictest) {
      all.us.insert(all.us.end(), block.begin(), block.end());
    }
    list.push_back(std::move(all));
  }
  return list;
}

std::vector<Durations> StageDurations(const JitterResult& result) {
  std::vector<Durations> list;
  for (std::size_t stage = 0; stage < task::kStageNames.size(); ++stage) {
    Durations durations{fmt::format("stage_{}", task::kStageNames[stage]), task::kStageNames[stage], {}};
    for (const Block& block : result.servo) {
      for (const Period& period : block.periods) {
        durations.us.push_back(1e-3 * period.stage_ns[stage]);
      }
    }
    list.push_back(std::move(durations));
  }
  return list;
}

std::vector<Durations> HopDurations(const JitterResult& result) {
  std::vector<Durations> list{{"hop_exposure", "rest of the exposure", {}},
                              {"hop_arrival", "read-out and arrival", {}},
                              {"hop_detection", "detection", {}},
                              {"hop_hand_over", "wait for the next tick", {}},
                              {"hop_tick", "tick, until torques written", {}},
                              {"image_to_torque", "from mid-exposure to torque", {}}};
  for (const HopTimes& hop : result.pictures) {
    if (hop.written_ns == 0) {
      continue;
    }
    const std::int64_t closed_ns = hop.stamp_ns + kExposureNs / 2;
    // A measurement may arrive after the tick that takes it has begun.
    const std::int64_t begun_ns = std::max(hop.woken_ns, hop.detected_ns);
    const std::array<std::int64_t, 6> ns{closed_ns - hop.stamp_ns,         hop.arrived_ns - closed_ns,
                                         hop.detected_ns - hop.arrived_ns, begun_ns - hop.detected_ns,
                                         hop.written_ns - begun_ns,        hop.written_ns - hop.stamp_ns};
    for (std::size_t i = 0; i < ns.size(); ++i) {
      list[i].us.push_back(1e-3 * static_cast<double>(ns[i]));
    }
  }
  return list;
}

std::vector<WakeRatio> WakeRatios(const JitterResult& result) {
  const std::vector<std::vector<double>> servo = Wakes(result.servo);
  std::vector<WakeRatio> ratios{
      {"the sleeping thread", RatioOfPercentiles(servo, Wakes(result.sleeper), kTail)}};
  if (!result.cyclictest.empty()) {
    ratios.push_back({"cyclictest", RatioOfPercentiles(servo, result.cyclictest, kTail)});
  }
  return ratios;
}

std::vector<JitterCounts> CountsOf(const JitterResult& result) {
  return {{"servo", Sum(result.servo)}, {"sleeper", Sum(result.sleeper)}};
}

JitterVerdict Judge(const JitterResult& result) {
  const std::uint64_t overruns = Sum(result.servo).overruns;
  const double worst = Percentile(All(result.servo, &Period::response_ns), 1.0);
  if (overruns > 0) {
    return {false, fmt::format("Does not keep 1 kHz here: {} {} at least 1 ms late. The worst response took "
                               "{:.0f} us.",
                               overruns, overruns == 1 ? "period began" : "periods began", worst)};
  }
  return {true, fmt::format("Keeps 1 kHz here{}: the worst response took {:.0f} us of 1000.",
                            worst < 500.0 ? "" : ", with little to spare", worst)};
}

std::vector<Figure> JitterFigures(const JitterResult& result) {
  std::vector<Figure> figures;
  for (const auto& list : {LoopDurations(result), StageDurations(result), HopDurations(result)}) {
    for (const Durations& durations : list) {
      for (const auto& [mark, p] : kMarks) {
        figures.push_back(
            {fmt::format("{}_us_{}", durations.name, mark), Percentile(durations.us, p), "us", {}});
      }
    }
  }
  for (const WakeRatio& wake : WakeRatios(result)) {
    const bool of_cyclictest = wake.to == "cyclictest";
    const std::string name = of_cyclictest ? "wake_ratio_cyclictest_p999" : "wake_ratio_p999";
    figures.push_back({name, wake.ratio.value, "", kGoalRatio});
    figures.push_back({name + "_low", wake.ratio.low, "", {}});
    figures.push_back({name + "_high", wake.ratio.high, "", {}});
  }
  for (const JitterCounts& counts : CountsOf(result)) {
    const auto add = [&](const char* what, auto count) {
      figures.push_back({fmt::format("{}_{}", counts.name, what), static_cast<double>(count), "", {}});
    };
    add("overruns", counts.sum.overruns);
    add("fault_ticks", counts.sum.fault_ticks);
    add("page_faults", counts.sum.page_faults);
    add("voluntary_switches", counts.sum.voluntary_switches);
    add("involuntary_switches", counts.sum.involuntary_switches);
  }
  figures.push_back({"pictures", static_cast<double>(result.pictures.size()), "", {}});
  return figures;
}

}  // namespace fovea::bench
