// SPDX-License-Identifier: Apache-2.0
// The recorded command line can be typed again in a shell.
#include "firmware/host/config/command_line.hpp"

#include <gtest/gtest.h>

#include <array>

namespace fovea::config {
namespace {

TEST(CommandLine, PlainWordsStayAsTheyAre) {
  const std::array<const char*, 4> words{"/usr/bin/fovea-sim", "run", "theory/open-loop",
                                         "--set=servo.lambda=3"};
  EXPECT_EQ(CommandLine(4, words.data()), "fovea-sim run theory/open-loop --set=servo.lambda=3");
}

TEST(CommandLine, WordsThatAShellWouldChangeAreQuoted) {
  const std::array<const char*, 5> words{"fovea-sim", "faults.frame_loss_s=[1,2]", "", "$(it)", "it's"};
  EXPECT_EQ(CommandLine(5, words.data()), R"(fovea-sim 'faults.frame_loss_s=[1,2]' '' '$(it)' 'it'\''s')");
}

}  // namespace
}  // namespace fovea::config
