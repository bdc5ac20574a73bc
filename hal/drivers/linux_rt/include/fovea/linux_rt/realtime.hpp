// Makes the calling thread a real-time one, as far as the machine allows.
#pragma once

#include <string>
#include <vector>

namespace fovea::linux_rt {

struct RealtimeOptions {
  int fifo_priority = 80;   // of SCHED_FIFO
  bool lock_memory = true;  // mlockall, now and for all that comes
  int stack_prefault_kib = 256;
};

// Asks for each in turn. Returns one line for each that could not be had, in words that say what to do; an
// empty list means that all could. Call it once, before the loop. Real-time: no.
std::vector<std::string> MakeThreadRealtime(const RealtimeOptions& options);

// Lowers the calling thread's claim on the processor (nice), for work that must not disturb the loop, and
// gives it the name [at most 15 letters] that top and perf show.
void MakeThreadYielding(const char* name);

}  // namespace fovea::linux_rt
