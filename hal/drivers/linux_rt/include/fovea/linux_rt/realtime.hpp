// Makes the calling thread a real-time one, as far as the machine allows.
#pragma once

#include <string>
#include <vector>

namespace fovea::linux_rt {

struct RealtimeOptions {
  int fifo_priority = 80;   // of SCHED_FIFO
  bool lock_memory = true;  // mlockall, now and for all that comes
  int stack_prefault_kib = 256;
  int cpu = -1;            // the one that the thread stays on; -1: any
  bool keep_awake = true;  // the processor sleeps no deeper than it wakes from at once (/dev/cpu_dma_latency)
  bool keep_memory = true;  // the heap gives nothing back to the system, so that it need not ask again
};

// Asks for each in turn, and for timers without slack. Returns one line for each that could not be had, in
// words that say what to do; an empty list means that all could. Call it once, before the loop. What holds
// for the process stays so until its end. Real-time: no.
std::vector<std::string> MakeThreadRealtime(const RealtimeOptions& options);

// Lowers the calling thread's claim on the processor (nice), for work that must not disturb the loop, and
// gives it the name [at most 15 letters] that top and perf show.
void MakeThreadYielding(const char* name);

}  // namespace fovea::linux_rt
