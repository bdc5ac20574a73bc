// SPDX-License-Identifier: Apache-2.0
// Whole runs: simulator, camera, detector and servo in one process, judged against the simulator's truth.
#pragma once

#include <gtest/gtest.h>

#include <iostream>
#include <string>
#include <vector>

#include "fovea/linux_rt/heap_counter.hpp"
#include "sim/app/run.hpp"

namespace fovea::test {

// Runs a shipped scenario with its keys changed by `assignments`; writes no files.
inline sim::Summary RunShipped(const std::string& name, const std::vector<std::string>& assignments = {},
                               sim::RunOptions options = {}) {
  options.report = false;
  options.show_progress = false;
  return sim::RunScenario(sim::LoadScenario(name, assignments), options);
}

inline std::string LastMode(const sim::Summary& s) { return s.modes.empty() ? "" : s.modes.back().mode; }
inline std::string LastReason(const sim::Summary& s) { return s.modes.empty() ? "" : s.modes.back().reason; }

// Requirements for every run without a latched fault.
inline void ExpectSound(const sim::Summary& s) {
  EXPECT_EQ(s.limit_violations, 0U);
  EXPECT_EQ(s.contact_ticks, 0U);
  EXPECT_TRUE(s.faults.empty());
  EXPECT_EQ(s.records_dropped, 0U);
#if defined(FOVEA_SANITIZED)
  EXPECT_FALSE(linux_rt::HeapCounterActive()) << "a sanitizer replaces the heap";
#else
  ASSERT_TRUE(s.heap_allocations_in_tick.has_value()) << "the heap counter is not active";
  EXPECT_EQ(*s.heap_allocations_in_tick, 0U);
#endif
}

inline void PrintResidual(const sim::Summary& s) {
  std::cout << s.scenario << ", seed " << s.seed << ": ";
  if (s.tracking_error_px_rms) {
    std::cout << "tracking " << *s.tracking_error_px_rms << " px rms";
  } else {
    std::cout << s.final_error_px_rms.value_or(-1) << " px rms, " << s.final_error_lateral_mm.value_or(-1)
              << " mm sideways, " << s.final_error_depth_mm.value_or(-1) << " mm in depth, settled after "
              << s.settle_time_s.value_or(-1) << " s";
  }
  std::cout << "; " << s.verdict << '\n';
}

}  // namespace fovea::test
