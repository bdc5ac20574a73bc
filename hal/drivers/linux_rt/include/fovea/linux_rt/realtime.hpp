// SPDX-License-Identifier: Apache-2.0
// Makes the calling thread a real-time one, as far as the machine allows.
#pragma once

#include <string>
#include <vector>

namespace fovea::linux_rt {

struct RealtimeOptions {
  int fifo_priority = 80;   // of SCHED_FIFO
  bool lock_memory = true;  // mlockall, present and future pages
  int stack_prefault_kib = 256;
  int cpu = -1;             // the thread stays on this processor; -1: any
  bool keep_awake = true;   // no deep sleep of the processor, which delays wake-ups (/dev/cpu_dma_latency)
  bool keep_memory = true;  // the heap returns nothing to the system, so that it need not request it again
};

// Applies each option, and sets timers without slack. Returns one line for each that failed, with what to do
// about it; an empty list means success. Call it once, before the loop. Settings of the process stay until
// its end. Real-time: no.
std::vector<std::string> MakeThreadRealtime(const RealtimeOptions& options);

// Lowers the calling thread's priority (nice), for work that must not disturb the loop, and gives it the name
// [at most 15 letters] that top and perf show.
void MakeThreadYielding(const char* name);

}  // namespace fovea::linux_rt
