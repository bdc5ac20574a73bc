// SPDX-License-Identifier: Apache-2.0
// Runs of one target from random starts, by simulator processes. Their rows are kept in a folder.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/folder_lock.hpp"
#include "tools/fovea/atlas/figures.hpp"
#include "tools/fovea/atlas/progress.hpp"
#include "tools/fovea/atlas/workers.hpp"

namespace fovea::atlas {

class Batch {
 public:
  // Keeps the rows in `folder`/rows.jsonl; with `resume`, rows that exist there count as done. `given`: the
  // starts instead of random ones. InputError: the folder cannot be written, is in use, or has rows of
  // another heading, or the simulator refuses the heading's assignments.
  Batch(const Heading& heading, const std::filesystem::path& folder, int jobs, bool resume,
        const std::vector<Start>& given = {});

  // The values that the first start's run draws in this case, as in its summary ("truth"). It simulates 0.1
  // s. InputError, which begins with `what`: the simulator refuses the case.
  nlohmann::json Try(const Case& truth, const std::string& what);

  // Simulates the first `runs` starts in each case, except those that are done. std::runtime_error: the
  // simulator refuses a run of a case that is no trial.
  void Execute(const std::vector<Case>& cases, int runs, Progress& progress);

  // Judges the first `runs` starts that failed in one of `cases` and converged in none. A start is judged
  // once.
  void JudgeFailures(const std::vector<Case>& cases, int runs);

  // The figures of a case's first `runs` starts.
  [[nodiscard]] Figures FiguresOf(const std::string& case_name, int runs) const;
  // The rows of a case, by the index of their start.
  [[nodiscard]] const std::map<int, Row>& rows(const std::string& case_name = "") const {
    return rows_->rows(case_name);
  }
  [[nodiscard]] const Heading& heading() const { return heading_; }
  [[nodiscard]] const std::string& scenario() const { return scenario_; }

 private:
  struct Task {
    const Case* truth = nullptr;
    int index = 0;
  };
  // The file of a run with this ending; its folder for "".
  [[nodiscard]] std::filesystem::path File(const Task& task, const char* ending) const;
  const Start& StartOf(int index);
  void Begin(int tag, const Task& task, const std::vector<std::string>& more);
  void Finish(const Task& task, int exit_code);
  void RemoveOutput(const Task& task) const;

  const Heading heading_;
  const std::string scenario_;
  const Scene scene_;
  const Sampler sampler_;
  const std::filesystem::path folder_;
  const std::size_t jobs_;
  std::optional<config::FolderLock> lock_;
  std::optional<RowFile> rows_;
  std::map<int, Start> starts_;  // by index, once drawn
  Workers workers_;
};

}  // namespace fovea::atlas
