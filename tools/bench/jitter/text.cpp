// SPDX-License-Identifier: Apache-2.0
// The result as text for a terminal.
#include <fmt/format.h>

#include <cmath>
#include <map>

#include "tools/bench/jitter/result.hpp"

namespace fovea::bench {
namespace {

std::string Row(const Durations& durations, int digits) {
  std::string text = fmt::format("  {:<28}", durations.title);
  for (const double p : {0.0, 0.5, 0.99, 0.999, 0.9999, 1.0}) {
    text += fmt::format("{:>9.{}f}", Percentile(durations.us, p), digits);
  }
  return text + "\n";
}

std::string Table(const char* what, const std::vector<Durations>& list, int digits) {
  std::string text = fmt::format("  {:<28}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", what, "min", "p50", "p99",
                                 "p99.9", "p99.99", "max");
  for (const Durations& durations : list) {
    text += Row(durations, digits);
  }
  return text + "\n";
}

// One line for each bin, one bar for each kind; a bar's length is the logarithm of its count.
std::string Histogram(const std::vector<Durations>& kinds) {
  std::map<double, std::vector<std::int64_t>> rows;  // by the bin's upper edge
  std::string text = fmt::format("  {:<24}", "wake-up, counts");
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    text += fmt::format("{:<28}", kinds[k].title.substr(0, kinds[k].title.find(':')));
    for (const LogHistogram::Bin& bin : CountByLog(kinds[k].us).bins) {
      std::vector<std::int64_t>& counts = rows[bin.high];
      counts.resize(kinds.size());
      counts[k] += bin.count;
    }
  }
  text += "\n";
  for (const auto& [high, counts] : rows) {
    std::string bars;
    std::int64_t sum = 0;
    for (const std::int64_t count : counts) {
      constexpr double kPerDecade = 4.0;
      const auto length =
          count == 0 ? 0U : 1U + static_cast<unsigned>(kPerDecade * std::log10(static_cast<double>(count)));
      bars += fmt::format("{:>7} {:<20}", count, std::string(length, '#'));
      sum += count;
    }
    if (sum > 0) {
      text += fmt::format("  up to {:>9.1f} us {}\n", high, bars.substr(0, bars.find_last_not_of(' ') + 1));
    }
  }
  return text + "\n";
}

std::string Counts(const JitterResult& result) {
  std::string text = fmt::format("  {:<10}{:>10}{:>14}{:>22}{:>24}\n", "counts", "overruns", "page faults",
                                 "voluntary switches", "involuntary switches");
  for (const JitterCounts& counts : CountsOf(result)) {
    text +=
        fmt::format("  {:<10}{:>10}{:>14}{:>22}{:>24}\n", counts.name, counts.sum.overruns,
                    counts.sum.page_faults, counts.sum.voluntary_switches, counts.sum.involuntary_switches);
  }
  return text + "\n";
}

}  // namespace

std::string JitterText(const JitterResult& result) {
  const std::vector<Durations> loop = LoopDurations(result);
  std::vector<Durations> wakes;
  for (const Durations& durations : loop) {
    if (durations.title.find("wake-up") != std::string::npos) {
      wakes.push_back(durations);
    }
  }
  std::string text =
      fmt::format("  {}, {} cores, {}; load {}, policy {}, {} s of each\n\n", result.machine.kernel,
                  result.machine.cores, result.machine.processor, result.load, result.policy, result.seconds);
  text += Table("us", loop, 1) + Histogram(wakes) +
          Table("stages of the tick, us", StageDurations(result), 2) +
          Table("picture to torque, us", HopDurations(result), 0) + Counts(result);
  for (const WakeRatio& wake : WakeRatios(result)) {
    text += fmt::format(
        "  p99.9 of the servo's wake-up is {:.2f} times that of {} (90 %: {:.2f} to {:.2f}; goal {:g})\n",
        wake.ratio.value, wake.to, wake.ratio.low, wake.ratio.high, kGoalRatio);
  }
  if (result.cyclictest.empty()) {
    text += fmt::format("  cyclictest: {}\n", result.cyclictest_absent);
  }
  text += "  " + Judge(result).words + "\n";
  for (const std::string& limit : result.machine.limits) {
    text += fmt::format("  - {}\n", limit);
  }
  return text;
}

}  // namespace fovea::bench
