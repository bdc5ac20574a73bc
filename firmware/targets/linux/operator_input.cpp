#include "operator_input.hpp"

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
constexpr std::size_t kMostUnread = 4096;  // of a line that never ends

}  // namespace

std::optional<Word> OperatorInput::Next() {
  std::size_t end = buffer_.find('\n');
  while (end == std::string::npos && FillBuffer()) {
    end = buffer_.find('\n');
  }
  if (end == std::string::npos) {
    return std::nullopt;
  }
  const std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  last_ = std::chrono::steady_clock::now();
  for (const auto& [text, word] : kWords) {
    if (line == text) {
      return word;
    }
  }
  unknown_ = line;
  return Word::kAlive;
}

bool OperatorInput::FillBuffer() {
  pollfd wait{STDIN_FILENO, POLLIN, 0};
  if (ended_ || poll(&wait, 1, 0) != 1) {
    return false;
  }
  std::array<char, 256> some{};
  const auto got = read(STDIN_FILENO, some.data(), some.size());
  ended_ = got <= 0 || buffer_.size() > kMostUnread;
  if (!ended_) {
    buffer_.append(some.data(), static_cast<std::size_t>(got));
  }
  return !ended_;
}

double OperatorInput::silent_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - last_).count();
}

std::string OperatorInput::TakeUnknown() { return std::exchange(unknown_, {}); }

}  // namespace fovea::hw
