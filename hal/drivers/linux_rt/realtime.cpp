// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/realtime.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace fovea::linux_rt {
namespace {

std::string Reason() { return std::strerror(errno); }

// Touches the stack below, so that its pages are mapped before the loop needs them.
void PrefaultStack(int kib) {
  constexpr int kPage = 4096;
  volatile unsigned char page[kPage];
  page[0] = 1;
  if (kib > kPage / 1024) {
    PrefaultStack(kib - kPage / 1024);
  }
  page[kPage - 1] = page[0];  // keeps the frame alive across the call
}

// The setting holds while the file is open. It stays open until the process ends.
bool KeepProcessorAwake() {
  const int file = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  const std::int32_t latency_us = 0;
  return file >= 0 && write(file, &latency_us, sizeof(latency_us)) == sizeof(latency_us);
}

bool StayOn(int cpu) {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  CPU_SET(static_cast<std::size_t>(cpu), &cpus);
  errno = pthread_setaffinity_np(pthread_self(), sizeof(cpus), &cpus);
  return errno == 0;
}

}  // namespace

std::vector<std::string> MakeThreadRealtime(const RealtimeOptions& options) {
  std::vector<std::string> missing;
  sched_param param{};
  param.sched_priority = options.fifo_priority;
  if (sched_setscheduler(0, SCHED_FIFO, &param) != 0) {
    missing.push_back("no SCHED_FIFO (" + Reason() +
                      "): run as root, or set rtprio for your user in /etc/security/limits.d");
  }
  if (options.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    missing.push_back("memory is not locked (" + Reason() +
                      "): run as root, or set memlock for your user in /etc/security/limits.d");
  }
  if (options.cpu >= 0 && !StayOn(options.cpu)) {
    missing.push_back("cannot stay on processor " + std::to_string(options.cpu) + " (" + Reason() +
                      "): `nproc` prints how many there are");
  }
  if (options.keep_awake && !KeepProcessorAwake()) {
    missing.push_back("deep sleep of the processor is not disabled, /dev/cpu_dma_latency (" + Reason() +
                      "): run as root, or give your user write access by a udev rule");
  }
  if (options.keep_memory) {
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_MMAP_MAX, 0);
  }
  prctl(PR_SET_TIMERSLACK, 1UL);  // SCHED_FIFO has no slack; this helps a thread without it
  PrefaultStack(options.stack_prefault_kib);
  return missing;
}

void MakeThreadYielding(const char* name) {
  pthread_setname_np(pthread_self(), name);
  // On Linux the nice value belongs to the thread. Lowering one's own priority is always allowed.
  setpriority(PRIO_PROCESS, 0, 10);
}

}  // namespace fovea::linux_rt
