// What the person at the keyboard says, a word a line on standard input.
#pragma once

#include <unistd.h>

#include <optional>
#include <string>

namespace fovea::hw {

enum class Word {
  kAlive,    // an empty line, or anything unknown: somebody is there
  kEnable,   // the arm may move
  kTrack,    // steer by the target
  kHold,     // stand still
  kRecover,  // a robot that stopped shall start anew
  kEnd,
};

class OperatorInput {
 public:
  explicit OperatorInput(int fd = STDIN_FILENO) : fd_(fd) {}

  // The next word, if one was typed; never waits. An input that has ended, or is none, says nothing.
  std::optional<Word> Next();
  // The last unknown line, once.
  std::string TakeUnknown();

 private:
  bool FillBuffer();

  const int fd_;
  std::string buffer_;
  std::string unknown_;
  bool ended_ = false;
};

}  // namespace fovea::hw
