// SPDX-License-Identifier: Apache-2.0
#include "sim/run/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "firmware/host/config/terminal.hpp"

namespace fovea::sim {
namespace {

constexpr auto kBarInterval = std::chrono::milliseconds(80);
constexpr int kLineStepPercent = 25;
constexpr std::size_t kMostBar = 30;

// A terminal that cannot clear a line.
bool IsDumb() {
  const char* term = std::getenv("TERM");
  return term != nullptr && std::string_view(term) == "dumb";
}

}  // namespace

Progress::Progress(std::string name, double end_s, bool quiet)
    : name_(std::move(name)),
      end_s_(end_s),
      is_terminal_(isatty(STDERR_FILENO) == 1 && !IsDumb()),
      width_(config::StyleOf(STDERR_FILENO).width - 1) {
  if (!quiet) {
    speaker_.emplace(STDERR_FILENO);
  }
}

Progress::~Progress() {
  if (shown_ && is_terminal_) {
    speaker_->Put("\r\033[K");  // the table takes the bar's place
  }
}

void Progress::Update(double now_s, const char* note) {
  if (!speaker_) {
    return;
  }
  const double share = std::clamp(now_s / end_s_, 0.0, 1.0);
  if (is_terminal_) {
    const auto now = std::chrono::steady_clock::now();
    if (now >= next_look_) {
      next_look_ = now + kBarInterval;
      Show(share, now_s, note);
    }
  } else if (100.0 * share >= next_line_percent_) {
    next_line_percent_ += kLineStepPercent;
    Show(share, now_s, note);
  }
}

void Progress::Show(double share, double now_s, const char* note) {
  shown_ = true;
  const std::string figures =
      fmt::format("{:3.0f} %  {:.1f} of {:.1f} s  {}", 100.0 * share, now_s, end_s_, note);
  if (is_terminal_) {
    // The bar takes what the words leave; a line that wraps could not be drawn over.
    const std::size_t words = name_.size() + figures.size() + std::string_view(" [] ").size();
    const std::size_t bar = std::min(kMostBar, width_ - std::min(words, width_));
    const auto filled = static_cast<std::size_t>(share * static_cast<double>(bar));
    std::string line = fmt::format("{} [{:#<{}}{:.<{}}] {}", name_, "", filled, "", bar - filled, figures);
    line.resize(std::min(line.size(), width_));
    speaker_->Put("\r" + line + "\033[K");
  } else {
    speaker_->Say(fmt::format("{}: {}", name_, figures));
  }
}

}  // namespace fovea::sim
