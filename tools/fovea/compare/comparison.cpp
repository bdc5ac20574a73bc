// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/compare/comparison.hpp"

#include <fmt/format.h>

#include <cmath>

#include "firmware/host/config/input_error.hpp"

namespace fovea::compare {
namespace {

constexpr std::size_t kMostBuckets = 1000;

// Until Finish, `spread.rms` is the sum of squares.
void Add(double value, double t_s, Spread& spread) {
  spread.rms += value * value;
  if (std::fabs(value) > std::fabs(spread.worst)) {
    spread.worst = value;
    spread.worst_s = t_s;
  }
}

void Finish(std::size_t count, Spread& spread) {
  spread.rms = std::sqrt(spread.rms / static_cast<double>(count));
}

}  // namespace

Comparison Compare(const std::filesystem::path& log, const RecordedRun& run, const SimulatedArm& arm,
                   int window_ms) {
  Comparison result;
  result.window_ms = window_ms;
  result.deviations = report::Envelope(run.joints.size(), kMostBuckets);
  std::vector<double> tau_max;
  for (std::size_t i = 0; i < run.joints.size(); ++i) {
    result.joints.push_back({run.joints[i], run.slides[i], {}, {}, {}, {}});
    tau_max.push_back(arm.robot.model.joints[i].tau_max);
  }
  PlayerOutput output;
  output.on_tick = [&](const Deviation& deviation) {
    for (std::size_t i = 0; i < result.joints.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      Add(deviation.q[k], deviation.t_s, result.joints[i].q);
      Add(deviation.dq[k], deviation.t_s, result.joints[i].dq);
    }
    result.deviations.Add(deviation.t_s, {deviation.q.begin(), deviation.q.end()});
    result.end_s = deviation.t_s;
  };
  output.on_window = [&](const Lack& window) {
    for (std::size_t i = 0; i < result.joints.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      Add(window.ddq[k], window.t_s, result.joints[i].ddq);
      Add(window.torque[k], window.t_s, result.joints[i].torque);
    }
    result.windows.push_back(window);
  };
  constexpr int kTicksPerMs = static_cast<int>(1'000'000 / hal::kTickPeriodNs);
  Player player(run, arm, window_ms * kTicksPerMs, output);
  ReadMotion(log, [&](const hal::TickRecord& record) { player.Add(record); });
  if (result.windows.empty()) {
    throw config::InputError(
        fmt::format("{}: nowhere {} ms of states and commands follow each other without a gap; --window-ms "
                    "sets this time",
                    log.string(), window_ms));
  }
  result.ticks = player.ticks();
  for (JointFigures& joint : result.joints) {
    Finish(static_cast<std::size_t>(result.ticks), joint.q);
    Finish(static_cast<std::size_t>(result.ticks), joint.dq);
    Finish(result.windows.size(), joint.ddq);
    Finish(result.windows.size(), joint.torque);
  }
  result.causes = FindCauses(result.windows, tau_max);
  return result;
}

}  // namespace fovea::compare
