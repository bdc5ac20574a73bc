// SPDX-License-Identifier: Apache-2.0
// The progress of an atlas on standard error: a bar on a terminal, else one line per tenth.
#pragma once

#include <string>

namespace fovea::atlas {

class Progress {
 public:
  Progress(std::string name, int runs);
  ~Progress() { End(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(int done, int failed);
  void End();

 private:
  std::string name_;
  int runs_;
  int shown_tenth_ = 0;
  bool is_terminal_;
};

}  // namespace fovea::atlas
