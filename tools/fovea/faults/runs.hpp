// SPDX-License-Identifier: Apache-2.0
// The runs of an atlas: each is a simulator process, and an excerpt of what it wrote is kept on disk.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/folder_lock.hpp"
#include "tools/fovea/atlas/progress.hpp"
#include "tools/fovea/atlas/workers.hpp"

namespace fovea::matrix {

// A run, identified by its name.
struct Job {
  std::string name;
  std::string scenario;
  std::vector<std::string> assignments;
  std::optional<int> seed = std::nullopt;  // none: that of all runs
};

// The shell command that repeats `job`. `seed`: that of all runs.
std::string CommandOf(const Job& job, int seed);

// What is done with the runs.
struct RunKind {
  std::string program;     // for messages
  bool keeps_log = false;  // until the excerpt is made
  // What is kept of a run, from its summary and its folder.
  std::function<nlohmann::json(const Job& job, const nlohmann::json& summary,
                               const std::filesystem::path& folder)>
      excerpt;
};

class Runs {
 public:
  // Keeps its rows in `folder`/rows.jsonl. With `resume`, existing rows with the same servo, seed, scenario
  // and assignments count as done. InputError: the file cannot be written.
  Runs(const std::filesystem::path& folder, int seed, int jobs, bool resume, RunKind kind);

  // Runs the jobs that are not done yet. std::runtime_error: the simulator refuses one.
  void Execute(const std::vector<Job>& jobs, atlas::Progress& progress);

  // The excerpt of a run; null when the run did not finish.
  [[nodiscard]] const nlohmann::json& SummaryOf(const std::string& name) const;

 private:
  void Read();
  void Finish(const Job& job, int exit_code);
  [[nodiscard]] std::filesystem::path File(const std::string& name, const char* ending) const;

  RunKind kind_;
  std::filesystem::path folder_;
  std::optional<config::FolderLock> lock_;
  int seed_;
  std::size_t jobs_;
  std::ofstream stream_;
  std::map<std::string, nlohmann::json> rows_;
  atlas::Workers workers_;
};

}  // namespace fovea::matrix
