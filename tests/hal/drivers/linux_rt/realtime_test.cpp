// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/realtime.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <thread>

namespace fovea::linux_rt {
namespace {

// Each privilege is either granted or listed as missing, on any machine.
TEST(RealtimeTest, ListsEachMissingPrivilege) {
  std::thread thread([] {
    const std::vector<std::string> missing = MakeThreadRealtime({.fifo_priority = 10, .lock_memory = true});
    int named = 0;
    for (const std::string& line : missing) {
      named += line.find("SCHED_FIFO") != std::string::npos ? 1 : 0;
      EXPECT_NE(line.find("): "), std::string::npos) << "the line says how to get the privilege: " << line;
      EXPECT_EQ(line.find('\n'), std::string::npos);
    }
    EXPECT_EQ(sched_getscheduler(0) == SCHED_FIFO, named == 0);
  });
  thread.join();
  munlockall();  // later tests of this process run unlocked
}

TEST(RealtimeTest, ThreadStaysOnItsProcessorWithoutTimerSlack) {
  std::thread thread([] {
    const int here = sched_getcpu();
    MakeThreadRealtime({.fifo_priority = 10, .lock_memory = false, .cpu = here});
    cpu_set_t cpus;
    ASSERT_EQ(sched_getaffinity(0, sizeof(cpus), &cpus), 0);
    EXPECT_EQ(CPU_COUNT(&cpus), 1);
    EXPECT_EQ(sched_getcpu(), here);
    EXPECT_LE(prctl(PR_GET_TIMERSLACK), 1);
  });
  thread.join();
}

TEST(RealtimeTest, MissingProcessorIsNamed) {
  std::thread thread([] {
    const auto missing = MakeThreadRealtime({.fifo_priority = 10, .lock_memory = false, .cpu = 1000});
    const auto named = [](const std::string& line) {
      return line.find("processor 1000") != std::string::npos;
    };
    EXPECT_EQ(std::count_if(missing.begin(), missing.end(), named), 1);
  });
  thread.join();
}

TEST(RealtimeTest, YieldingLowersThePriorityOfTheThreadOnly) {
  const int before = getpriority(PRIO_PROCESS, 0);
  std::thread thread([] {
    MakeThreadYielding("fovea-test");
    EXPECT_EQ(getpriority(PRIO_PROCESS, 0), 10);
  });
  thread.join();
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), before);
}

}  // namespace
}  // namespace fovea::linux_rt
