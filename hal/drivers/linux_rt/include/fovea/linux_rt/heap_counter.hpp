// SPDX-License-Identifier: Apache-2.0
// Counts the heap calls of the calling thread while it is inside a counted region.
//
// The counting itself is done by the interposer (heap_interposer.cpp, target fovea_heap_interposer), which
// replaces malloc and related functions in the executable that links it. Without it nothing is counted, and
// HeapCounterActive() is false: a proof of "no heap" must check it first.
#pragma once

#include <cstdint>

namespace fovea::linux_rt {

// Real-time: all three, yes. Regions do not nest.
void EnterCountedRegion() noexcept;
void LeaveCountedRegion() noexcept;
// Heap calls (allocate, free, reallocate) of this thread inside counted regions so far.
[[nodiscard]] std::uint64_t CountedHeapCalls() noexcept;

// Whether a heap call of this thread is counted at all; makes one to find out. Real-time: no.
[[nodiscard]] bool HeapCounterActive() noexcept;

// For the interposer: called at every heap call.
void NoteHeapCall() noexcept;

}  // namespace fovea::linux_rt
