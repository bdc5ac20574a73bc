// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/wire/wire.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "firmware/host/config/program.hpp"
#include "fovea/franka/franka_arm.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "tools/bench/common/figure.hpp"
#include "tools/bench/common/shell.hpp"
#include "tools/bench/common/spread.hpp"
#include "tools/bench/wire/served_robot.hpp"

namespace fovea::bench {
namespace {

constexpr double kStatesPerSecond = 1000.0;
constexpr double kMostReserved = 1e6;  // states to reserve memory for

// std::runtime_error unless `status` is ok or a timeout: a state that has not arrived yet.
void CheckRobot(const hal::Status& status) {
  if (!status.ok() && status.code() != hal::StatusCode::kTimeout) {
    throw std::runtime_error(fmt::format("the robot: {} ({})", hal::ToString(status.code()), status.where()));
  }
}

// Answers each state at once with zero torques, which leave the arm where it is. Measures for `seconds` from
// the start of the motion: of wall time or, in lockstep, of the robot's time. std::runtime_error when the
// robot refuses or aborts the motion.
std::vector<Figure> Measure(franka::FrankaArm& arm, double seconds, bool lockstep) {
  linux_rt::MonotonicClock clock;
  std::vector<double> gaps_us;
  gaps_us.reserve(static_cast<std::size_t>(std::min(1.1 * seconds * kStatesPerSecond, kMostReserved)));
  std::int64_t begin_ns = clock.NowNs();
  std::int64_t last_ns = begin_ns;
  std::uint64_t first_state = 0;
  franka::FrankaCounters before;
  const auto measured_s = [&] {
    return lockstep ? static_cast<double>(arm.robot_state().message_id - first_state) / kStatesPerSecond
                    : 1e-9 * static_cast<double>(last_ns - begin_ns);
  };
  for (bool moves = false; !moves || measured_s() < seconds;) {
    hal::ArmState state;
    if (const hal::Status status = arm.Read(state); !status.ok()) {
      CheckRobot(status);
      const std::int64_t now_ns = clock.NowNs();
      if (now_ns - last_ns > hal::kNsPerSecond) {
        throw std::runtime_error("no state arrived for a second");
      }
      continue;
    }
    hal::ArmCommand command;
    command.state_sequence = state.sequence;
    command.num_joints = state.num_joints;
    CheckRobot(arm.Write(command));
    const std::int64_t now_ns = clock.NowNs();
    if (!moves && arm.phase() == franka::MotionPhase::kRunning) {  // from now on each state is answered
      moves = true;
      begin_ns = now_ns;
      first_state = arm.robot_state().message_id;
      before = arm.counters();
      gaps_us.clear();
    }
    gaps_us.push_back(1e-3 * static_cast<double>(now_ns - last_ns));
    last_ns = now_ns;
  }
  const franka::FrankaCounters& after = arm.counters();
  const double took_s = 1e-9 * static_cast<double>(last_ns - begin_ns);
  const auto states = static_cast<double>(after.states - before.states);
  return {{"states_per_s", states / took_s, "1/s", kStatesPerSecond},
          {"state_gap_p50_us", Percentile(gaps_us, 0.5), "us", {}},
          {"state_gap_p99_us", Percentile(gaps_us, 0.99), "us", {}},
          {"state_gap_max_us", Percentile(gaps_us, 1.0), "us", {}},
          {"answered_states", static_cast<double>(after.commands - before.commands) / states, "of all", {}},
          {"lost_states", static_cast<double>(after.lost_states - before.lost_states), "", {}},
          {"command_success_rate", arm.robot_state().control_command_success_rate, "", {}}};
}

}  // namespace

int RunWire(const WireArguments& arguments) {
  const std::filesystem::path program = SimulatorBeside("fovea-bench wire");
  const bool lockstep = arguments.pace == "lockstep";
  const ServedRobot robot(program, arguments.pace);
  franka::FrankaConfig config;
  config.host = "127.0.0.1";
  config.port = robot.port();
  franka::FrankaArm arm(config);
  const std::vector<Figure> figures = Measure(arm, arguments.seconds, lockstep);
  fmt::print("{}", arguments.json ? ToJson(figures) + "\n" : ToTable(figures));
  return config::kDone;
}

}  // namespace fovea::bench
