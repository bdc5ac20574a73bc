// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "firmware/host/config/printed_table.hpp"
#include "firmware/targets/linux/check_camera.hpp"
#include "firmware/targets/linux/robots/arm_drivers.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::hw {
namespace {

using Rows = std::vector<CheckRow>;

constexpr std::array kVerdictNames{"pass", "warn", "fail"};
constexpr double kNsPerUs = 1e3;
constexpr double kWakeWarnUs = 100.0;  // p99.9; a tenth of a period
constexpr double kWakeFailUs = 500.0;  // half of it

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
                  governor.empty() ? "no frequency scaling" : governor,
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
    rows.push_back({"privileges", Verdict::kPass, "all are granted", ""});
  }
  const double p999_us = static_cast<double>(late.Percentile(0.999)) / kNsPerUs;
  const Verdict verdict = p999_us < kWakeWarnUs   ? Verdict::kPass
                          : p999_us < kWakeFailUs ? Verdict::kWarn
                                                  : Verdict::kFail;
  rows.push_back(
      {"wake-up", verdict,
       fmt::format("p99.9 {:.0f} us, at most {:.0f} us in {} s", p999_us,
                   static_cast<double>(late.max_ns()) / kNsPerUs, config.check.seconds),
       verdict == Verdict::kPass ? "" : "end other programs; use a kernel with PREEMPT_RT; set loop.cpu"});
}

}  // namespace

std::vector<CheckRow> Check(const HwConfig& config) {
  Rows rows;
  const robots::Robot robot = LoadHwRobot(config);
  CheckComputer(config, rows);
  ArmDriverOf(config).make(config)->Check(config, robot, rows);
  CheckCamera(config, rows);
  if (config.HasCamera()) {
    // Latency, mount, focal length and load show only in motion.
    rows.push_back({"beliefs", Verdict::kPass, "unknown: this check does not move the arm",
                    "run with motion, then: fovea calibrate from-log LOG"});
  }
  return rows;
}

bool AnyFails(const Rows& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [](const CheckRow& row) { return row.verdict == Verdict::kFail; });
}

std::string ToTable(const Rows& rows, const config::TextStyle& style) {
  config::PrintedTable table(style);
  for (const CheckRow& row : rows) {
    const config::Paint paint = row.verdict == Verdict::kFail ? config::Paint::kBad : config::Paint::kPlain;
    table.Row(fmt::format("{:<6}{:<18}", kVerdictNames[static_cast<std::size_t>(row.verdict)], row.what),
              row.found, paint);
    if (!row.advice.empty()) {
      table.Row("", row.advice);
    }
  }
  return table.text();
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
