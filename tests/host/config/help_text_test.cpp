// SPDX-License-Identifier: Apache-2.0
// Help texts are wrapped to the terminal's width without losing a word.
#include "firmware/host/config/help_text.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace fovea::config {
namespace {

std::string Formatted(const std::string& text, std::size_t width) {
  return FormatHelp(text, {.width = width, .colour = false});
}

TEST(FormatHelpTest, KeepsLinesThatFit) {
  const std::string text = "Usage: fovea [OPTIONS]\n\nOptions:\n  -h,--help                   Print this\n";
  EXPECT_EQ(Formatted(text, 60), text);
}

TEST(FormatHelpTest, IndentsTheRestOfADescriptionToItsColumn) {
  EXPECT_EQ(Formatted("  --seed UINT                 seed of the random numbers, the same in each run\n", 60),
            "  --seed UINT                 seed of the random numbers,\n"
            "                              the same in each run\n");
}

TEST(FormatHelpTest, IndentsTheRestOfALineByTwoMore) {
  EXPECT_EQ(Formatted("  fovea report out/slow out/fast --out comparison.html\n", 40),
            "  fovea report out/slow out/fast --out\n"
            "    comparison.html\n");
  EXPECT_EQ(Formatted("Exit: 0 done, 1 goal missed, 2 wrong usage or input.\n", 40),
            "Exit: 0 done, 1 goal missed, 2 wrong\n"
            "usage or input.\n");
}

TEST(FittedTest, KeepsANumberWithItsPercentSign) {
  EXPECT_EQ(Fitted("speed 37 %, torque 13 %", 2, 21), "speed 37 %, torque\n  13 %\n");
  EXPECT_EQ(Fitted("speed 37 %, torque 13 %", 2, 22), "speed 37 %, torque\n  13 %\n");
}

TEST(FittedTest, KeepsANumberWithItsUnit) {
  for (const std::string unit : {"px", "mm", "s", "rad/s", "deg", "Nm,", "KiB)"}) {
    const std::string text = "settled after 2.42 " + unit;
    for (std::size_t width = 18; width < text.size(); ++width) {
      EXPECT_EQ(Fitted(text, 2, width), "settled after\n  2.42 " + unit + "\n") << width;
    }
    EXPECT_EQ(Fitted(text, 2, text.size()), text + "\n");
  }
  EXPECT_EQ(Fitted("a run of 12 seconds", 2, 12), "a run of 12\n  seconds\n") << "not a unit";
  EXPECT_EQ(Fitted("the letter m is wide", 2, 11), "the letter\n  m is wide\n") << "not a number";
}

TEST(FormatHelpTest, KeepsAWordThatIsLongerThanTheLine) {
  const std::string word(80, 'x');
  EXPECT_EQ(Formatted("  --only TEXT                 " + word + " more\n", 60),
            "  --only TEXT                 " + word + "\n" + std::string(30, ' ') + "more\n");
  EXPECT_EQ(Formatted(word + "\n", 60), word + "\n");
}

TEST(FormatHelpTest, BreaksALongListOfChoicesBehindCommas) {
  EXPECT_EQ(
      Formatted("  --dictionary TEXT:{4x4_50,4x4_100,4x4_250,5x5_50,5x5_100,5x5_250} of the board\n", 40),
      "  --dictionary\n    TEXT:{4x4_50,4x4_100,4x4_250,5x5_50,\n    5x5_100,5x5_250} of the board\n");
}

TEST(FormatHelpTest, LosesNoWordAtAnyWidth) {
  const std::string text =
      "Fovea's tools: reports and replays of logs.\n\nOptions:\n"
      "  -j,--jobs INT:INT in [1 - 256]\n                              jobs that run in parallel; default: "
      "one for every two cores\n  fovea atlas --faults --jobs 2 --only ball.approach\n";
  const auto words = [](const std::string& of) {
    std::istringstream stream(of);
    std::string all;
    for (std::string word; stream >> word;) {
      all += word + " ";
    }
    return all;
  };
  for (std::size_t width = 60; width <= 100; ++width) {
    const std::string formatted = Formatted(text, width);
    EXPECT_EQ(words(formatted), words(text));
    std::istringstream lines(formatted);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), width) << line;
    }
  }
}

TEST(FormatHelpTest, MakesHeadingsBoldWhereAsked) {
  EXPECT_EQ(FormatHelp("Options:\n  --json\nExit: 0 done.\n", {.width = 80, .colour = true}),
            "\033[1mOptions:\033[0m\n  --json\nExit: 0 done.\n");
}

}  // namespace
}  // namespace fovea::config
