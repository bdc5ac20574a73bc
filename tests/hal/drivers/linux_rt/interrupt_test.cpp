// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/interrupt.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace fovea::linux_rt {
namespace {

void AwaitFirst(const Interrupt& interrupt) {
  while (!interrupt.Came()) {
    usleep(1000);
  }
}

TEST(Interrupt, FirstSignalIsOnlyRecorded) {
  Interrupt interrupt;
  EXPECT_FALSE(interrupt.Came());
  kill(getpid(), SIGINT);
  AwaitFirst(interrupt);
}

// In a child process, whose last action writes a byte into a pipe.
TEST(Interrupt, SecondSignalRunsTheLastActionAndEndsTheProcess) {
  int words[2];
  ASSERT_EQ(pipe(words), 0);
  const pid_t child = fork();
  if (child == 0) {
    Interrupt interrupt;
    interrupt.SetLastAct([&words] { static_cast<void>(write(words[1], "!", 1) == 1); });
    kill(getpid(), SIGTERM);
    AwaitFirst(interrupt);
    kill(getpid(), SIGINT);
    for (;;) {
      pause();
    }
  }
  close(words[1]);
  char word = 0;
  EXPECT_EQ(read(words[0], &word, 1), 1);
  EXPECT_EQ(word, '!');
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGINT) << "the exit status tells a shell the signal";
  close(words[0]);
}

}  // namespace
}  // namespace fovea::linux_rt
