#include "fovea/linux_rt/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace fovea::linux_rt {
namespace {

std::string Reason() { return std::strerror(errno); }

// Touches the stack below, so that its pages are there before the loop needs them.
void PrefaultStack(int kib) {
  constexpr int kPage = 4096;
  volatile unsigned char page[kPage];
  page[0] = 1;
  if (kib > kPage / 1024) {
    PrefaultStack(kib - kPage / 1024);
  }
  page[kPage - 1] = page[0];  // keeps the frame alive across the call
}

}  // namespace

std::vector<std::string> MakeThreadRealtime(const RealtimeOptions& options) {
  std::vector<std::string> missing;
  sched_param param{};
  param.sched_priority = options.fifo_priority;
  if (sched_setscheduler(0, SCHED_FIFO, &param) != 0) {
    missing.push_back("no SCHED_FIFO (" + Reason() +
                      "): run as root, or give your user an rtprio in /etc/security/limits.d");
  }
  if (options.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    missing.push_back("memory is not locked (" + Reason() +
                      "): run as root, or give your user a memlock in /etc/security/limits.d");
  }
  PrefaultStack(options.stack_prefault_kib);
  return missing;
}

void MakeThreadYielding(const char* name) {
  pthread_setname_np(pthread_self(), name);
  // On Linux the nice value belongs to the thread. Lowering one's own claim is always allowed.
  setpriority(PRIO_PROCESS, 0, 10);
}

}  // namespace fovea::linux_rt
