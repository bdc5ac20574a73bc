// SPDX-License-Identifier: Apache-2.0
// Without the interposer the counter must report that it is inactive.
#include <gtest/gtest.h>

#include "fovea/linux_rt/heap_counter.hpp"

TEST(HeapCounterOffTest, ReportsThatItIsInactive) { EXPECT_FALSE(fovea::linux_rt::HeapCounterActive()); }
