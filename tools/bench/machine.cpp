#include "machine.hpp"

#include <sys/utsname.h>

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

MachineFacts LookAtMachine(const std::vector<std::string>& missing) {
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
        "the kernel is not PREEMPT_RT: a driver or a long system call may hold the thread up");
  }
  const std::string governor = FirstLine("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (!governor.empty() && governor != "performance") {
    facts.limits.push_back("the CPU governor is \"" + governor +
                           "\": cpupower frequency-set --governor performance keeps the clock up");
  }
  if (!FirstLine("/sys/devices/system/cpu/cpuidle/current_driver").empty() &&
      FirstLine("/sys/devices/system/cpu/cpuidle/current_driver") != "none") {
    facts.limits.emplace_back(
        "idle states are on: holding /dev/cpu_dma_latency at 0 keeps the processor awake");
  }
  if (CpuInfo("flags").find(" hypervisor") != std::string::npos) {
    facts.limits.emplace_back("this is a virtual machine: its host may take the processor away at any time");
  }
  return facts;
}

}  // namespace fovea::bench
