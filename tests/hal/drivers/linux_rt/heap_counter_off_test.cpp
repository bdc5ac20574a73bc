// In a program without the interposer the counter must not pretend.
#include <gtest/gtest.h>

#include "fovea/linux_rt/heap_counter.hpp"

TEST(HeapCounterOffTest, ReportsThatItIsInactive) { EXPECT_FALSE(fovea::linux_rt::HeapCounterActive()); }
