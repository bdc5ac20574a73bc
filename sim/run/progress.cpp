#include "sim/run/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace fovea::sim {
namespace {

constexpr auto kBarInterval = std::chrono::milliseconds(80);
constexpr int kLineStepPercent = 25;
constexpr int kBarWidth = 30;

// Ignores write errors: the run continues without a reader.
void Say(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

Progress::Progress(std::string name, double end_s, bool quiet)
    : name_(std::move(name)), end_s_(end_s), quiet_(quiet), is_terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_ && is_terminal_) {
    Say("\r\033[K");  // the table takes the bar's place
  }
}

void Progress::Update(double now_s, const char* note) {
  if (quiet_) {
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
    const int filled = static_cast<int>(share * kBarWidth);
    Say(fmt::format("\r{} [{}{}] {}\033[K", name_, std::string(static_cast<std::size_t>(filled), '#'),
                    std::string(static_cast<std::size_t>(kBarWidth - filled), '.'), figures));
  } else {
    Say(fmt::format("{}: {}\n", name_, figures));
  }
}

}  // namespace fovea::sim
