// Programs run beside each other, each a process of its own: what one does to itself, no other notices.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace fovea::atlas {

class Children {
 public:
  // Kills what still runs.
  ~Children();

  // Starts `arguments`, whose first is the program's path, with what it prints in the files `out` and `err`.
  // It is killed after `limit`, and when this process dies, in whatever way. `tag` is the caller's. Throws
  // std::runtime_error.
  void Start(int tag, const std::vector<std::string>& arguments, const std::filesystem::path& out,
             const std::filesystem::path& err, std::chrono::seconds limit);

  struct Ended {
    int tag = 0;
    int exit_code = -1;  // -1: ended by a signal, or killed at its limit
  };
  // Waits until one has ended. There must be one.
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
