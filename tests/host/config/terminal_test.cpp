// SPDX-License-Identifier: Apache-2.0
// Output has colours only where a person sees them, and fits the terminal.
#include "firmware/host/config/terminal.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "firmware/host/config/program.hpp"

namespace fovea::config {
namespace {

TEST(TerminalTest, ColoursAreForATerminalThatAllowsThem) {
  EXPECT_TRUE(ColourFor(true, nullptr, "xterm-256color"));
  EXPECT_TRUE(ColourFor(true, nullptr, nullptr));
  EXPECT_FALSE(ColourFor(false, nullptr, "xterm-256color"));
  EXPECT_FALSE(ColourFor(true, "1", "xterm-256color"));
  EXPECT_FALSE(ColourFor(true, "", "xterm-256color")) << "set, although empty";
  EXPECT_FALSE(ColourFor(true, nullptr, "dumb"));
}

TEST(TerminalTest, WidthIsTheTerminalsFrom60To100) {
  EXPECT_EQ(WidthFor(true, 80), 80U);
  EXPECT_EQ(WidthFor(true, 59), 60U);
  EXPECT_EQ(WidthFor(true, 1), 60U);
  EXPECT_EQ(WidthFor(true, 101), 100U);
  EXPECT_EQ(WidthFor(true, 0), 100U) << "unknown";
  EXPECT_EQ(WidthFor(false, 80), kUnbroken);
}

TEST(TerminalTest, FileIsNoTerminal) {
  const int fd = open("/dev/null", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(fd, 0);
  EXPECT_FALSE(UsesColour(fd));
  EXPECT_EQ(TerminalWidth(fd), kUnbroken);
  EXPECT_EQ(StyleOf(fd).width, kUnbroken);
  EXPECT_FALSE(StyleOf(fd).colour);
  close(fd);
}

TEST(TerminalTest, PaintIsForAStyleWithColours) {
  const TextStyle coloured{.width = 80, .colour = true};
  EXPECT_EQ(Painted("good", Paint::kGood, coloured), "\033[32mgood\033[0m");
  EXPECT_EQ(Painted("bad", Paint::kBad, coloured), "\033[31mbad\033[0m");
  EXPECT_EQ(Painted("head", Paint::kBold, coloured), "\033[1mhead\033[0m");
  EXPECT_EQ(Painted("plain", Paint::kPlain, coloured), "plain");
  EXPECT_EQ(Painted("", Paint::kBad, coloured), "");
  EXPECT_EQ(Painted("bad", Paint::kBad, {}), "bad");
}

TEST(TerminalTest, OnlyWhatATerminalShowsIsPrintedAsItIs) {
  for (const char* text : {"", "a b~.png", "\u00fcber.png", "\u2192", "\U0001F600", "\u00a0", "\\x1b"}) {
    EXPECT_EQ(Printable(text), text);
  }
  EXPECT_EQ(Printable("a\x1b[2J\nb\x7f"), "a\\x1b[2J\\x0ab\\x7f");
  EXPECT_EQ(Printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(Printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J")
      << "the control character U+009B";
  EXPECT_EQ(Printable("\xff\xc3(\xe2\x86"), "\\xff\\xc3(\\xe2\\x86") << "no UTF-8";
  EXPECT_EQ(Printable("\xc0\xaf\xed\xa0\x80\xf4\x90\x80\x80"),
            "\\xc0\\xaf\\xed\\xa0\\x80\\xf4\\x90\\x80\\x80")
      << "too long, a half of UTF-16, too large";
}

TEST(TerminalTest, ErrorIsOneLineUnlessATerminalBreaksIt) {
  const std::string words = "the first half of a message\nand its second half, which is long";
  EXPECT_EQ(ErrorText("fovea", words, kUnbroken),
            "fovea: the first half of a message and its second half, which is long\n");
  EXPECT_EQ(ErrorText("fovea", words, 60),
            "fovea: the first half of a message and its second half,\n  which is long\n");
}

}  // namespace
}  // namespace fovea::config
