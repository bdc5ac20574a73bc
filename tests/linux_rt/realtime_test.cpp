#include "fovea/linux_rt/realtime.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <thread>

namespace fovea::linux_rt {
namespace {

// Whatever the machine grants, each thing is either had or named.
TEST(RealtimeTest, HasOrNamesEachThing) {
  std::thread thread([] {
    const std::vector<std::string> missing = MakeThreadRealtime({.fifo_priority = 10, .lock_memory = true});
    int named = 0;
    for (const std::string& line : missing) {
      named += line.find("SCHED_FIFO") != std::string::npos ? 1 : 0;
      EXPECT_NE(line.find("limits.d"), std::string::npos) << "it says what to do: " << line;
      EXPECT_EQ(line.find('\n'), std::string::npos);
    }
    EXPECT_EQ(sched_getscheduler(0) == SCHED_FIFO, named == 0);
  });
  thread.join();
  munlockall();  // not for the rest of this process
}

TEST(RealtimeTest, YieldingLowersTheThreadAlone) {
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
