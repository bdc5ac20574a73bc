// SPDX-License-Identifier: Apache-2.0
// The progress of an atlas on standard error: a bar on a terminal, else one line per tenth.
#pragma once

#include <string>

namespace fovea::atlas {

class Progress {
 public:
  // `things`: what is done, `counted`: what Show counts among them, such as "failed".
  Progress(std::string name, int total, std::string things = "runs", std::string counted = "failed");
  ~Progress() { End(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(int done, int counted);
  void End();

 private:
  std::string name_;
  int total_;
  std::string things_;
  std::string counted_;
  int shown_tenth_ = 0;
  bool is_terminal_;
};

}  // namespace fovea::atlas
