// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/signal_queue.hpp"

#include <gtest/gtest.h>
#include <pthread.h>

namespace fovea::linux_rt {
namespace {

TEST(SignalQueue, EachSignalIsDeliveredOnce) {
  const SignalQueue queue({SIGUSR1, SIGUSR2});
  EXPECT_EQ(queue.Next(0), -1);
  pthread_kill(pthread_self(), SIGUSR2);
  EXPECT_EQ(queue.Next(500), SIGUSR2);
  EXPECT_EQ(queue.Next(0), -1);
}

TEST(SignalQueue, RestoresTheSignalMask) {
  sigset_t before;
  sigset_t after;
  pthread_sigmask(SIG_BLOCK, nullptr, &before);
  { const SignalQueue queue({SIGUSR1}); }
  pthread_sigmask(SIG_BLOCK, nullptr, &after);
  EXPECT_EQ(sigismember(&before, SIGUSR1), sigismember(&after, SIGUSR1));
}

// A closed terminal ends a program, except one that ignores SIGHUP, such as under nohup.
TEST(SignalQueue, HangUpIsLeftOutWhereItIsIgnored) {
  {
    const SignalQueue queue({SIGHUP});
    pthread_kill(pthread_self(), SIGHUP);
    EXPECT_EQ(queue.Next(500), SIGHUP);
  }
  std::signal(SIGHUP, SIG_IGN);
  {
    const SignalQueue queue({SIGHUP, SIGUSR1});
    pthread_kill(pthread_self(), SIGHUP);
    EXPECT_EQ(queue.Next(0), -1);
  }
  std::signal(SIGHUP, SIG_DFL);
}

}  // namespace
}  // namespace fovea::linux_rt
