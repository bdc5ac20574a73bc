// SPDX-License-Identifier: Apache-2.0
// The operator's words on standard input, one per line.
#pragma once

#include <unistd.h>

#include <optional>
#include <string>

namespace fovea::hw {

enum class Word {
  kAlive,    // an empty line, or anything unknown: the operator is present
  kEnable,   // the arm may move
  kTrack,    // track the target
  kHold,     // stand still
  kRecover,  // make a stopped robot recover
  kEnd,
};

class OperatorInput {
 public:
  explicit OperatorInput(int fd = STDIN_FILENO) : fd_(fd) {}

  // The next word, if one was typed; never waits. None for an input that has ended or does not exist.
  std::optional<Word> Next();
  // Returns the last unknown line once, then "".
  std::string TakeUnknown();

 private:
  bool FillBuffer();

  const int fd_;
  std::string buffer_;
  std::string unknown_;
  bool ended_ = false;
};

}  // namespace fovea::hw
