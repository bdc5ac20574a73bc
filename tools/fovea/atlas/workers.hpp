// SPDX-License-Identifier: Apache-2.0
// Runs of the simulator in parallel, in processes of their own (`fovea-sim runs`). A process does one run
// after another: starting it takes longer than a run. A run that crashes takes its process with it, and no
// other run.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fovea::atlas {

class Workers {
 public:
  explicit Workers(std::filesystem::path simulator) : simulator_(std::move(simulator)) {}
  // Kills the processes that still run.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  // Starts `fovea-sim run` with `words` as its arguments. Its output goes to the files `out` and `err`. The
  // run is killed after `limit`, and whenever this process ends. `tag` is returned in Ended.
  // Throws std::runtime_error.
  void Start(int tag, const std::vector<std::string>& words, const std::filesystem::path& out,
             const std::filesystem::path& err, std::chrono::seconds limit);

  struct Ended {
    int tag = 0;
    int exit_code = -1;  // -1: its process ended by a signal, or was killed at the limit
  };
  // Waits until a run has ended. At least one must be running.
  Ended WaitForOne();

  [[nodiscard]] std::size_t running() const;

 private:
  struct Run {
    int tag = 0;
    std::chrono::steady_clock::time_point deadline;
  };
  struct Worker {
    pid_t pid = 0;
    int requests = -1;  // descriptors of the ends of its pipes
    int replies = -1;
    std::string reply;  // a line that is not complete
    std::optional<Run> run;
  };

  Worker& Idle();
  [[nodiscard]] std::optional<Ended> Read(Worker& worker);
  Ended Bury(std::size_t index);

  const std::filesystem::path simulator_;
  std::vector<Worker> workers_;
};

}  // namespace fovea::atlas
