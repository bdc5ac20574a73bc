// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/heap_counter.hpp"

#include <cstdlib>

namespace fovea::linux_rt {
namespace {

// Plain thread-local data: access to it must not allocate. Volatile, because the compiler assumes that malloc
// does not call back into this file.
thread_local volatile bool in_region = false;
thread_local volatile std::uint64_t heap_calls = 0;

}  // namespace

void EnterCountedRegion() noexcept { in_region = true; }
void LeaveCountedRegion() noexcept { in_region = false; }
std::uint64_t CountedHeapCalls() noexcept { return heap_calls; }

void NoteHeapCall() noexcept {
  if (in_region) {
    heap_calls = heap_calls + 1;
  }
}

bool HeapCounterActive() noexcept {
  const bool was_in_region = in_region;
  const std::uint64_t before = heap_calls;
  in_region = true;
  void* volatile block = std::malloc(1);  // volatile: the compiler must not remove the pair
  std::free(block);
  in_region = was_in_region;
  const bool seen = heap_calls >= before + 2;
  heap_calls = before;
  return seen;
}

}  // namespace fovea::linux_rt
