// SPDX-License-Identifier: Apache-2.0
// Runs programs in parallel, each in its own process, so that a crash does not affect the others.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace fovea::atlas {

class Children {
 public:
  // Kills the children that still run.
  ~Children();

  // Starts the program `arguments[0]` with the rest as its arguments. Its output goes to the files `out` and
  // `err`. The child is killed after `limit`, and whenever this process ends. `tag` is returned in Ended.
  // Throws std::runtime_error.
  void Start(int tag, const std::vector<std::string>& arguments, const std::filesystem::path& out,
             const std::filesystem::path& err, std::chrono::seconds limit);

  struct Ended {
    int tag = 0;
    int exit_code = -1;  // -1: ended by a signal, or killed at its limit
  };
  // Waits until a child has ended. At least one must be running.
  Ended WaitForOne();

  [[nodiscard]] std::size_t running() const { return children_.size(); }

 private:
  struct Child {
    pid_t pid = 0;
    int tag = 0;
    std::chrono::steady_clock::time_point deadline;
  };
  std::vector<Child> children_;
};

}  // namespace fovea::atlas
