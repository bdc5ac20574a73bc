// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/saved_scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/faults/fault_reader.hpp"
#include "sim/scenario/roll_pitch_yaw.hpp"
#include "sim/scenario/target_scene.hpp"

namespace fovea::sim {
namespace {

constexpr double kRests = 1e-3;  // joint speeds below this are left out [rad/s, m/s]

// The inverse of RollPitchYaw [deg].
std::vector<double> RollPitchYawOf(const Eigen::Matrix3d& R) {
  const double pitch = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  return {std::atan2(R(2, 1), R(2, 2)) / kRadPerDeg, pitch / kRadPerDeg,
          std::atan2(R(1, 0), R(0, 0)) / kRadPerDeg};
}

std::vector<double> ToList(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

// Moves the windows to a time that begins `by_s` later.
class WindowShift : public FaultReader {
 public:
  explicit WindowShift(double by_s) : by_s_(by_s) {}

  void Window(const FaultField& /*field*/, TimeWindow& window, const char* /*not_served*/ = nullptr) const {
    window = {Shifted(window.start_s), Shifted(window.end_s)};
  }

 private:
  // Rounded to nanoseconds: a window that begins with a tick still does.
  [[nodiscard]] double Shifted(double time_s) const {
    return std::max(std::round((time_s - by_s_) * 1e9) / 1e9, 0.0);
  }

  double by_s_;
};

// "section.key = value" lines as TOML tables, for all keys of `scenario` that have not their default.
std::string ToToml(Scenario& scenario) {
  Scenario defaults;
  const std::map<std::string, std::string> usual = ScenarioKeys(defaults).Values();
  std::string text;
  std::string section;
  const config::KeyTable keys = ScenarioKeys(scenario);
  for (const config::Key& key : keys.keys()) {
    if (key.default_text == usual.at(key.name)) {
      continue;
    }
    const std::size_t dot = key.name.find('.');
    if (key.name.substr(0, dot) != section) {
      section = key.name.substr(0, dot);
      text += fmt::format("\n[{}]\n", section);
    }
    text += fmt::format("{} = {}\n", key.name.substr(dot + 1), key.default_text);
  }
  return text;
}

}  // namespace

std::string SaveScenario(const RunDescription& about, const PresentState& present) {
  const Scenario& scenario = about.scenario;
  Scenario saved = scenario;
  const double now_s = static_cast<double>(present.truth.stamp_ns) * 1e-9;
  const Eigen::VectorXd& zero = about.robot_truth.encoder_zero;
  saved.arm.q_start = ToList(zero.size() > 0 ? present.truth.q + zero : present.truth.q);
  saved.arm.realism = "ideal";  // the keys that it set are saved one by one
  const bool rests = present.truth.dq.cwiseAbs().maxCoeff() < kRests;
  saved.arm.dq_start = rests ? std::vector<double>{} : ToList(present.truth.dq);
  std::string note;
  if (present.target_touched || scenario.target.motion == "still") {
    saved.target.motion = "still";
    saved.target.turn_deg_s = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double true_offset = about.bench.target.position[i] - scenario.target.position[i];
      saved.target.position[i] = present.truth.p_BO[static_cast<Eigen::Index>(i)] - true_offset;
    }
    saved.target.rpy_deg = RollPitchYawOf(present.truth.R_BO);
  } else {
    note = "# The target's path begins anew.\n";
  }
  saved.faults = present.faults;
  WindowShift shift(now_s);
  Fields(shift, saved.faults);
  const config::KeyTable keys = ScenarioKeys(saved);
  for (const auto& [key, value] : present.tuned) {
    keys.Apply({key, value, "a setting changed in motion"});
  }
  saved.run.description = fmt::format("{} at {:.3f} s of a live run", scenario.name, now_s);
  return fmt::format("# {} as it was after {:.3f} s.\n{}", scenario.name, now_s, note) + ToToml(saved);
}

}  // namespace fovea::sim
