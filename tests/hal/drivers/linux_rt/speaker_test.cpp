// SPDX-License-Identifier: Apache-2.0
// A thread that prints a line never waits for the reader.
#include "fovea/linux_rt/speaker.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <string>

namespace fovea::linux_rt {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

class SpeakerTest : public testing::Test {
 protected:
  SpeakerTest() { EXPECT_EQ(pipe(ends_.data()), 0); }
  ~SpeakerTest() override {
    CloseReader();
    close(ends_[1]);
  }
  void CloseReader() {
    if (ends_[0] >= 0) {
      close(ends_[0]);
      ends_[0] = -1;
    }
  }
  void Fill() {
    const int flags = fcntl(ends_[1], F_GETFL);
    fcntl(ends_[1], F_SETFL, flags | O_NONBLOCK);
    const std::string text(4096, 'x');
    while (write(ends_[1], text.data(), text.size()) > 0) {
    }
    fcntl(ends_[1], F_SETFL, flags);
  }
  // Reads all pending output.
  std::string Read() {
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    std::string text;
    std::array<char, 4096> some{};
    for (ssize_t got = 0; (got = read(ends_[0], some.data(), some.size())) > 0;) {
      text.append(some.data(), static_cast<std::size_t>(got));
    }
    return text;
  }
  std::array<int, 2> ends_{-1, -1};
};

TEST_F(SpeakerTest, LinesComeWholeAndInOrder) {
  std::string said;
  {
    Speaker speaker(ends_[1]);
    for (int k = 0; k < 100; ++k) {
      speaker.Say("line " + std::to_string(k));
      said += "line " + std::to_string(k) + "\n";
    }
    speaker.Wait(10s);
    EXPECT_EQ(speaker.unsaid(), 0U);
  }
  EXPECT_EQ(Read(), said);
}

TEST_F(SpeakerTest, FullPipeDelaysNeitherSpeakerNorExit) {
  Fill();
  const auto begin = Clock::now();
  {
    Speaker speaker(ends_[1]);
    for (int k = 0; k < 10'000; ++k) {
      speaker.Say("a line");
    }
    speaker.Wait(50ms);
    EXPECT_EQ(speaker.unsaid(), 10'000U);
  }
  const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
  std::printf("10000 lines into a full pipe: %lld ms, including the end\n",
              static_cast<long long>(took.count()));
  EXPECT_LT(took, 5s);
}

TEST_F(SpeakerTest, ReturningReaderGetsTheQueuedLines) {
  fcntl(ends_[1], F_SETPIPE_SZ, 4096);
  Speaker speaker(ends_[1]);
  for (int k = 0; k < 100; ++k) {
    speaker.Say(std::string(100, 'x'));
  }
  std::size_t heard = 0;
  for (int k = 0; k < 1000 && heard < 10'100; ++k) {
    heard += Read().size();
    speaker.Wait(10ms);
  }
  EXPECT_EQ(heard, 10'100U);
  EXPECT_EQ(speaker.unsaid(), 0U);
}

TEST_F(SpeakerTest, WithoutAReaderLinesAreOnlyCounted) {
  std::signal(SIGPIPE, SIG_IGN);
  CloseReader();
  Speaker speaker(ends_[1]);
  speaker.Say("nobody hears this");
  speaker.Wait(10s);
  EXPECT_EQ(speaker.unsaid(), 1U);
}

}  // namespace
}  // namespace fovea::linux_rt
