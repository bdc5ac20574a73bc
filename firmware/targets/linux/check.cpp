#include "check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "fovea/model/dynamics.hpp"

namespace fovea::hw {
namespace {

using Rows = std::vector<CheckRow>;

constexpr std::array kVerdictNames{"pass", "warn", "fail"};
constexpr double kNsPerUs = 1e3;
constexpr double kWakeWarnUs = 100.0;  // p99.9; a tenth of a period
constexpr double kWakeFailUs = 500.0;  // half of it
constexpr int kStates = 1000;          // of the robot that are looked at
constexpr double kGravityWarn = 1.0;   // a joint's torque beside the model's [Nm]
constexpr double kGravityFail = 4.0;

std::string FirstLine(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

void CheckComputer(const HwConfig& config, Rows& rows) {
  const bool rt = FirstLine("/sys/kernel/realtime") == "1";
  rows.push_back({"kernel", rt ? Verdict::kPass : Verdict::kWarn, rt ? "PREEMPT_RT" : "not PREEMPT_RT",
                  rt ? "" : "install a real-time kernel (Debian: linux-image-rt-amd64)"});
  const std::string governor = FirstLine("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  const bool steady = governor.empty() || governor == "performance";
  rows.push_back({"processor speed", steady ? Verdict::kPass : Verdict::kWarn,
                  governor.empty() ? "no scaling is seen" : governor,
                  steady ? "" : "cpupower frequency-set -g performance"});

  std::vector<std::string> missing;
  linux_rt::DurationHistogram late;
  std::jthread thread([&] {
    missing = linux_rt::MakeThreadRealtime({.fifo_priority = config.loop.priority, .cpu = config.loop.cpu});
    linux_rt::MonotonicClock clock;
    std::int64_t deadline_ns = clock.NowNs();
    const std::int64_t end_ns = deadline_ns + static_cast<std::int64_t>(config.check.seconds * 1e9);
    while (deadline_ns < end_ns) {
      deadline_ns += hal::kTickPeriodNs;
      static_cast<void>(clock.WaitUntil(deadline_ns));  // CLOCK_MONOTONIC does not close
      late.Add(clock.NowNs() - deadline_ns);
    }
  });
  thread.join();
  for (const std::string& line : missing) {
    rows.push_back({"privileges", Verdict::kWarn, line.substr(0, line.find(": ")),
                    line.find(": ") == std::string::npos ? "" : line.substr(line.find(": ") + 2)});
  }
  if (missing.empty()) {
    rows.push_back({"privileges", Verdict::kPass, "all that was asked for", ""});
  }
  const double p999_us = static_cast<double>(late.Percentile(0.999)) / kNsPerUs;
  const Verdict verdict = p999_us < kWakeWarnUs   ? Verdict::kPass
                          : p999_us < kWakeFailUs ? Verdict::kWarn
                                                  : Verdict::kFail;
  rows.push_back(
      {"wake-up", verdict,
       fmt::format("p99.9 {:.0f} us, at most {:.0f} us in {} s", p999_us,
                   static_cast<double>(late.max_ns()) / kNsPerUs, config.check.seconds),
       verdict == Verdict::kPass ? "" : "end what else runs here; a kernel with PREEMPT_RT; loop.cpu"});
}

// What the robot's joints feel beside what the model says that they carry.
CheckRow CheckGravity(const robots::Robot& robot, const hal::ArmState& state) {
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  const model::VecN q = model::ToVector(state.q, franka::kJoints);
  model::ComputePoses(robot.model, q, poses);
  model::ComputeDynamics(robot.model, poses, model::VecN::Zero(franka::kJoints), dynamics);
  double worst = 0.0;
  int joint = 0;
  for (int i = 0; i < franka::kJoints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double off = std::fabs(state.tau_meas[k] - state.tau_applied[k] - dynamics.g[i]);
    joint = off > worst ? i + 1 : joint;
    worst = std::max(worst, off);
  }
  const Verdict verdict = worst < kGravityWarn   ? Verdict::kPass
                          : worst < kGravityFail ? Verdict::kWarn
                                                 : Verdict::kFail;
  return {"gravity", verdict,
          fmt::format("measured torques are {:.2f} Nm off the model's at joint {}", worst, joint),
          verdict == Verdict::kPass
              ? ""
              : "is arm.load_* what the flange carries, and does the robot know of it?"};
}

CheckRow CheckRange(const robots::Robot& robot, const hal::ArmState& state, double margin) {
  for (int i = 0; i < franka::kJoints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = robot.model.joints[k];
    if (state.q[k] < joint.q_min + margin || state.q[k] > joint.q_max - margin) {
      return {"joint ranges", Verdict::kFail, fmt::format("joint {} stands at {:.3f} rad", i + 1, state.q[k]),
              fmt::format("lead it by hand to between {:.3f} and {:.3f} rad", joint.q_min + margin,
                          joint.q_max - margin)};
    }
  }
  return {"joint ranges", Verdict::kPass, "all joints are inside", ""};
}

void CheckRobot(const HwConfig& config, const robots::Robot& robot, Rows& rows) {
  franka::FrankaArm arm(MakeFrankaConfig(config, /*allow_motion=*/false));
  rows.push_back({"robot", Verdict::kPass, "speaks version 5 of the interface", ""});
  hal::ArmState state;
  bool has_state = false;
  hal::Status status;
  for (int k = 0; k < kStates; ++k) {
    status = arm.Read(state);
    has_state = has_state || status.ok();
    if (!status.ok() && status.code() != hal::StatusCode::kTimeout) {
      rows.push_back({"robot's mode", Verdict::kFail, status.where(),
                      "release the stop, clear the error, switch to external control"});
      return;
    }
  }
  const franka::FrankaCounters& c = arm.counters();
  const std::uint64_t lost = c.lost_states + c.timeouts;
  const bool ready = has_state && arm.robot_state().robot_mode == franka::RobotMode::kIdle;
  rows.push_back({"robot's mode", ready ? Verdict::kPass : Verdict::kFail, ready ? "idle" : "not idle",
                  ready ? "" : "switch it to external control, and end what else moves it"});
  rows.push_back({"states",
                  lost == 0 ? Verdict::kPass : (lost < kStates / 100 ? Verdict::kWarn : Verdict::kFail),
                  fmt::format("{} came, {} lost or late", c.states, lost),
                  lost == 0 ? "" : "a cable straight to the robot, no switch and no other traffic"});
  if (has_state) {
    rows.push_back(CheckRange(robot, state, config.servo.config.guard.joint_position_margin));
    rows.push_back(CheckGravity(robot, state));
  }
}

}  // namespace

std::vector<CheckRow> Check(const HwConfig& config) {
  Rows rows;
  const robots::Robot robot = LoadHwRobot(config);
  CheckComputer(config, rows);
  try {
    CheckRobot(config, robot, rows);
  } catch (const franka::NetworkError& error) {
    rows.push_back(
        {"robot", Verdict::kFail, error.what(), "see robot.host, robot.port and the network's cable"});
  }
  return rows;
}

bool AnyFails(const Rows& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [](const CheckRow& row) { return row.verdict == Verdict::kFail; });
}

std::string ToTable(const Rows& rows) {
  std::string text;
  for (const CheckRow& row : rows) {
    text += fmt::format("  {:<6}{:<18}{}\n", kVerdictNames[static_cast<std::size_t>(row.verdict)], row.what,
                        row.found);
    if (!row.advice.empty()) {
      text += fmt::format("{:26}{}\n", "", row.advice);
    }
  }
  return text;
}

std::string ToJson(const Rows& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const CheckRow& row : rows) {
    json.push_back({{"what", row.what},
                    {"verdict", kVerdictNames[static_cast<std::size_t>(row.verdict)]},
                    {"found", row.found},
                    {"advice", row.advice}});
  }
  return json.dump(2) + "\n";
}

}  // namespace fovea::hw
