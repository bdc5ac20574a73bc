// SPDX-License-Identifier: Apache-2.0
// Typed words, in pieces, unknown ones, and endless lines.
#include "firmware/targets/linux/operator_input.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>

namespace fovea::hw {
namespace {

class OperatorInputTest : public testing::Test {
 protected:
  OperatorInputTest() { EXPECT_EQ(pipe(ends_.data()), 0); }
  ~OperatorInputTest() override {
    close(ends_[0]);
    if (ends_[1] >= 0) {
      close(ends_[1]);
    }
  }
  void Type(const std::string& text) {
    EXPECT_EQ(write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  std::array<int, 2> ends_{-1, -1};
};

TEST_F(OperatorInputTest, WordsComeInOrder) {
  OperatorInput input(ends_[0]);
  EXPECT_EQ(input.Next(), std::nullopt);
  Type("enable\ntr");
  EXPECT_EQ(input.Next(), Word::kEnable);
  EXPECT_EQ(input.Next(), std::nullopt);
  Type("ack\n\nenabel\nhold\n");
  EXPECT_EQ(input.Next(), Word::kTrack);
  EXPECT_EQ(input.Next(), Word::kAlive);
  EXPECT_EQ(input.TakeUnknown(), "");
  EXPECT_EQ(input.Next(), Word::kAlive);
  EXPECT_EQ(input.TakeUnknown(), "enabel");
  EXPECT_EQ(input.Next(), Word::kHold);
  close(ends_[1]);
  ends_[1] = -1;
  EXPECT_EQ(input.Next(), std::nullopt);
}

TEST_F(OperatorInputTest, EndlessLineDoesNotBlockLaterWords) {
  OperatorInput input(ends_[0]);
  for (int k = 0; k < 5; ++k) {
    Type(std::string(20'000, 'x'));
    for (int look = 0; look < 10; ++look) {
      EXPECT_EQ(input.Next(), std::nullopt);
    }
  }
  Type("\nhold\n");
  EXPECT_EQ(input.Next(), Word::kAlive);
  EXPECT_LT(input.TakeUnknown().size(), 5000U);
  EXPECT_EQ(input.Next(), Word::kHold);
}

}  // namespace
}  // namespace fovea::hw
