// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace fovea::atlas {

Progress::Progress(std::string name, int total, std::string things, std::string counted)
    : name_(std::move(name)),
      total_(total),
      things_(std::move(things)),
      counted_(std::move(counted)),
      is_terminal_(isatty(STDERR_FILENO) == 1) {}

void Progress::Show(int done, int counted) {
  constexpr int kWidth = 30;
  const std::string figures = fmt::format("{} of {} {}, {} {}", done, total_, things_, counted, counted_);
  if (is_terminal_) {
    const auto filled = static_cast<std::size_t>(kWidth * done / total_);
    fmt::print(stderr, "\r{} [{}{}] {}\033[K", name_, std::string(filled, '#'),
               std::string(kWidth - filled, '.'), figures);
  } else if (10 * done / total_ > shown_tenth_) {
    shown_tenth_ = 10 * done / total_;
    fmt::print(stderr, "{}: {}\n", name_, figures);
  }
  std::fflush(stderr);
}

void Progress::End() {
  if (is_terminal_) {
    fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
  }
}

}  // namespace fovea::atlas
