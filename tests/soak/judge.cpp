// SPDX-License-Identifier: Apache-2.0
#include "tests/soak/judge.hpp"

#include <cmath>

namespace fovea::soak {
namespace {

constexpr double kWarmUp = 0.1;     // share of the run time
constexpr std::size_t kEnough = 5;  // samples of memory
constexpr std::uint64_t kEnoughValues = 8;
constexpr double kChance = 6.0;  // [sigma]; never exceeded by chance

}  // namespace

Growth JudgeMemory(const std::vector<MemorySample>& samples, double most) {
  if (samples.empty()) {
    return {};
  }
  const double begin_s = samples.front().robot_s;
  const double warm_s = begin_s + kWarmUp * (samples.back().robot_s - begin_s);
  double n = 0.0;
  double x_mean = 0.0;
  double y_mean = 0.0;
  for (const MemorySample& sample : samples) {
    if (sample.robot_s >= warm_s) {
      n += 1.0;
      x_mean += (sample.robot_s - x_mean) / n;
      y_mean += (sample.bytes - y_mean) / n;
    }
  }
  if (n < static_cast<double>(kEnough)) {
    return {};
  }
  double xx = 0.0;
  double xy = 0.0;
  for (const MemorySample& sample : samples) {
    if (sample.robot_s >= warm_s) {
      xx += (sample.robot_s - x_mean) * (sample.robot_s - x_mean);
      xy += (sample.robot_s - x_mean) * (sample.bytes - y_mean);
    }
  }
  const double growth = xx > 0.0 ? xy / xx * (samples.back().robot_s - warm_s) : 0.0;
  return {growth, growth > most};
}

void Spread::Add(double x) {
  ++count;
  const double before = x - mean;
  mean += before / static_cast<double>(count);
  squares += before * (x - mean);
}

double Spread::Sigma() const { return count > 1 ? std::sqrt(squares / static_cast<double>(count - 1)) : 0.0; }

Drift JudgeDrift(const Tenths& tenths, double least) {
  const Spread& first = tenths.front();
  const Spread& last = tenths.back();
  if (first.count < kEnoughValues || last.count < kEnoughValues) {
    return {};
  }
  const double variance = first.Sigma() * first.Sigma() / static_cast<double>(first.count) +
                          last.Sigma() * last.Sigma() / static_cast<double>(last.count);
  const double apart = std::fabs(last.mean - first.mean);
  Drift drift;
  drift.sigmas = variance > 0.0 ? apart / std::sqrt(variance) : (apart > 0.0 ? HUGE_VAL : 0.0);
  drift.drifts = !std::isfinite(apart) || (apart > least && drift.sigmas > kChance);
  return drift;
}

}  // namespace fovea::soak
