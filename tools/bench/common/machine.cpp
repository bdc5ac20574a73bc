// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/common/machine.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <thread>

namespace fovea::bench {
namespace {

// The first line of a file; "" when there is none.
std::string FirstLine(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  return line;
}

// The value of the first line of /proc/cpuinfo with this name.
std::string CpuInfo(const std::string& name) {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(name, 0) == 0 && line.find(": ") != std::string::npos) {
      return line.substr(line.find(": ") + 2);
    }
  }
  return "";
}

}  // namespace

MachineFacts LookAtMachine(const std::vector<std::string>& missing, bool kept_awake) {
  MachineFacts facts;
  utsname names{};
  if (uname(&names) == 0) {
    facts.kernel = std::string(names.sysname) + " " + names.release;
  }
  facts.processor = CpuInfo("model name");
  facts.cores = static_cast<int>(std::thread::hardware_concurrency());
  facts.limits = missing;
  if (FirstLine("/sys/kernel/realtime") != "1") {
    facts.limits.emplace_back(
        "the kernel is not PREEMPT_RT: a driver or a long system call may delay the thread");
  }
  const std::string governor = FirstLine("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (!governor.empty() && governor != "performance") {
    facts.limits.push_back("the CPU governor is \"" + governor +
                           "\": cpupower frequency-set --governor performance keeps the clock high");
  }
  const std::string idle_driver = FirstLine("/sys/devices/system/cpu/cpuidle/current_driver");
  if (!kept_awake && !idle_driver.empty() && idle_driver != "none") {
    facts.limits.emplace_back(
        "idle states are on: holding /dev/cpu_dma_latency at 0 keeps the processor awake (--policy fifo does "
        "this)");
  }
  if (CpuInfo("flags").find(" hypervisor") != std::string::npos) {
    facts.limits.emplace_back("this is a virtual machine: its host may take the processor away at any time");
  }
  return facts;
}
ProcessorTime::ProcessorTime() : start_(Now()) {}

// The first line of /proc/stat: user, nice, system, idle, iowait, irq, softirq, steal, in clock ticks.
ProcessorTime::Counts ProcessorTime::Now() {
  std::ifstream stream("/proc/stat");
  std::string name;
  stream >> name;
  std::array<double, 8> ticks{};
  for (double& value : ticks) {
    stream >> value;
  }
  const auto per_s = static_cast<double>(sysconf(_SC_CLK_TCK));
  Counts counts;
  for (const double value : ticks) {
    counts.total += value / per_s;
  }
  counts.busy = (ticks[0] + ticks[1] + ticks[2] + ticks[5] + ticks[6]) / per_s;
  counts.stolen = ticks[7] / per_s;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& time : {usage.ru_utime, usage.ru_stime}) {
      counts.own += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
  }
  return counts;
}

ProcessorTime::Shares ProcessorTime::SinceStart() const {
  const Counts now = Now();
  const double total = now.total - start_.total;
  if (!(total > 0.0)) {
    return {};
  }
  const double others = (now.busy - start_.busy) - (now.own - start_.own);
  return {(now.stolen - start_.stolen) / total, others > 0.0 ? others / total : 0.0};
}

std::vector<std::string> InWords(const ProcessorTime::Shares& shares) {
  std::vector<std::string> words;
  if (shares.stolen > 0.001) {
    words.push_back(
        fmt::format("meanwhile the host took {:.1f} % of the processors' time away from this virtual machine",
                    100.0 * shares.stolen));
  }
  if (shares.others > 0.05) {
    words.push_back(fmt::format("meanwhile other processes used {:.0f} % of the processors' time",
                                100.0 * shares.others));
  }
  return words;
}

}  // namespace fovea::bench
