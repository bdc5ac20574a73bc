// What the person at the keyboard says, a word a line on standard input.
#pragma once

#include <chrono>
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
  // The next word, if one was typed; never waits. An input that has ended, or is none, says nothing.
  std::optional<Word> Next();
  // Since the last line, or since the start.
  [[nodiscard]] double silent_s() const;
  // The last unknown line, once.
  std::string TakeUnknown();

 private:
  bool FillBuffer();

  std::string buffer_;
  std::string unknown_;
  bool ended_ = false;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace fovea::hw
