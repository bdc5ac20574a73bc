// SPDX-License-Identifier: Apache-2.0
// The child processes of this process, from the kernel's list for each thread.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <vector>

namespace fovea::test {

inline std::vector<pid_t> OwnChildren() {
  std::vector<pid_t> children;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream list(thread.path() / "children");
    for (pid_t child = 0; list >> child;) {
      children.push_back(child);
    }
  }
  return children;
}

}  // namespace fovea::test
