// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/operator_input.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace fovea::hw {
namespace {

constexpr std::array<std::pair<const char*, Word>, 5> kWords{{{"enable", Word::kEnable},
                                                              {"track", Word::kTrack},
                                                              {"hold", Word::kHold},
                                                              {"recover", Word::kRecover},
                                                              {"end", Word::kEnd}}};
constexpr std::size_t kMostUnread = 4096;  // bytes of a line without an end; more are dropped
constexpr int kMostReads = 32;             // reads in one call, for an input without an end

}  // namespace

std::optional<Word> OperatorInput::Next() {
  std::size_t end = buffer_.find('\n');
  for (int reads = 0; end == std::string::npos && reads < kMostReads && FillBuffer(); ++reads) {
    end = buffer_.find('\n');
  }
  if (end == std::string::npos) {
    return std::nullopt;
  }
  const std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  for (const auto& [text, word] : kWords) {
    if (line == text) {
      return word;
    }
  }
  unknown_ = line;
  return Word::kAlive;
}

bool OperatorInput::FillBuffer() {
  pollfd wait{fd_, POLLIN, 0};
  if (ended_ || poll(&wait, 1, 0) != 1) {
    return false;
  }
  std::array<char, 256> some{};
  const auto got = read(fd_, some.data(), some.size());
  ended_ = got <= 0;
  if (ended_) {
    return false;
  }
  if (buffer_.size() > kMostUnread) {
    buffer_.clear();
  }
  buffer_.append(some.data(), static_cast<std::size_t>(got));
  return true;
}

std::string OperatorInput::TakeUnknown() { return std::exchange(unknown_, {}); }

}  // namespace fovea::hw
