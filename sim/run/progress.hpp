// SPDX-License-Identifier: Apache-2.0
// Shows the progress of a run on standard error: a bar on a terminal, otherwise a line for each quarter.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

#include "fovea/linux_rt/speaker.hpp"

namespace fovea::sim {

class Progress {
 public:
  // `quiet`: show nothing.
  Progress(std::string name, double end_s, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Cheap unless it is time for an output. `note` describes the current activity.
  void Update(double now_s, const char* note);

 private:
  void Show(double share, double now_s, const char* note);

  std::string name_;
  double end_s_;
  bool is_terminal_;
  std::size_t width_;  // of a line on the terminal
  bool shown_ = false;
  int next_line_percent_ = 0;
  std::chrono::steady_clock::time_point next_look_;
  std::optional<linux_rt::Speaker> speaker_;  // none if quiet; the run does not wait for who reads it
};

}  // namespace fovea::sim
