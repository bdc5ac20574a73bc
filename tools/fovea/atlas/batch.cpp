// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/batch.hpp"

#include <fmt/format.h>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "tools/bench/common/shell.hpp"
#include "tools/fovea/atlas/files.hpp"

namespace fovea::atlas {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kRunLimit{900};  // of wall time; a run takes some seconds

}  // namespace

Batch::Batch(const Heading& heading, const fs::path& folder, int jobs, bool resume,
             const std::vector<Start>& given)
    : heading_(heading),
      scenario_(ScenarioOf(heading.target)),
      scene_(LoadScene(heading.target, SceneAssignments(heading.assignments))),
      sampler_(scene_),
      folder_(folder),
      jobs_(static_cast<std::size_t>(jobs)),
      workers_(bench::SimulatorBeside("fovea atlas")) {
  std::error_code error;
  fs::create_directories(folder_ / "runs", error);
  if (error) {
    throw config::InputError(folder_.string() + ": cannot create this folder");
  }
  lock_.emplace(folder_);
  rows_.emplace(folder_ / "rows.jsonl", heading_, resume);
  for (const Start& start : given) {
    starts_.emplace(static_cast<int>(starts_.size()), start);
  }
}

fs::path Batch::File(const Task& task, const char* ending) const {
  return folder_ / (RunFolder(task.truth->name, task.index) + ending);
}

const Start& Batch::StartOf(int index) {
  const auto known = starts_.find(index);
  return known != starts_.end() ? known->second
                                : starts_.emplace(index, sampler_.Draw(heading_.seed, index)).first->second;
}

void Batch::Begin(int tag, const Task& task, const std::vector<std::string>& more) {
  const Start& start = StartOf(task.index);
  std::vector<std::string> command{
      scenario_, "--seed", std::to_string(start.run_seed), "--no-report", "--json", "--out", File(task, "")};
  // One renderer keeps one core busy.
  for (const char* option : {"--pictures", "failed", "--renderers", "1"}) {
    command.emplace_back(option);
  }
  std::vector<std::string> assignments = AssignmentsOf(heading_, task.truth->truth, start);
  assignments.insert(assignments.end(), more.begin(), more.end());
  for (const std::string& assignment : assignments) {
    command.emplace_back("--set");
    command.push_back(assignment);
  }
  workers_.Start(tag, command, File(task, ".json"), File(task, ".txt"), kRunLimit);
}

void Batch::RemoveOutput(const Task& task) const {
  std::error_code ignored;
  fs::remove(File(task, ".json"), ignored);
  fs::remove(File(task, ".txt"), ignored);
}

nlohmann::json Batch::Try(const Case& truth, const std::string& what) {
  Case trial = truth;
  trial.name = "trial";  // the runs of the case keep their files
  const Task task{&trial, 0};
  Begin(0, task, {"run.duration_s=0.1"});
  const Workers::Ended ended = workers_.WaitForOne();
  const bool ran = ended.exit_code == config::kDone || ended.exit_code == config::kGoalMissed;
  const std::string out = Content(File(task, ".json"));
  const std::string reason = ReasonOf(Content(File(task, ".txt")));
  RemoveOutput(task);
  std::error_code ignored;
  fs::remove_all(File(task, ""), ignored);
  if (!ran) {
    throw config::InputError(fmt::format("{}: {}", what, reason));
  }
  return nlohmann::json::parse(out).at("truth");
}

void Batch::Execute(const std::vector<Case>& cases, int runs, Progress& progress) {
  std::vector<Task> left;
  int done = 0;
  int failed = 0;
  for (const Case& truth : cases) {
    for (int index = 0; index < runs; ++index) {
      const auto row = rows(truth.name).find(index);
      if (row == rows(truth.name).end()) {
        left.push_back({&truth, index});
      } else {
        ++done;
        failed += row->second.converged ? 0 : 1;
      }
    }
  }
  std::size_t next = 0;
  for (;;) {
    for (; next < left.size() && workers_.running() < jobs_; ++next) {
      Begin(static_cast<int>(next), left[next], {});
    }
    if (workers_.running() == 0) {
      return;
    }
    const Workers::Ended ended = workers_.WaitForOne();
    const Task& task = left[static_cast<std::size_t>(ended.tag)];
    Finish(task, ended.exit_code);
    failed += rows(task.truth->name).at(task.index).converged ? 0 : 1;
    progress.Show(++done, failed);
  }
}

void Batch::JudgeFailures(const std::vector<Case>& cases, int runs) {
  std::vector<int> indexes;
  std::vector<Start> starts;
  for (int index = 0; index < runs; ++index) {
    bool has_failed = false;
    bool has_converged = rows_->judgements().contains(index);
    for (const Case& truth : cases) {
      const auto row = rows(truth.name).find(index);
      if (row != rows(truth.name).end()) {
        (row->second.converged ? has_converged : has_failed) = true;
      }
    }
    if (has_failed && !has_converged) {
      indexes.push_back(index);
      starts.push_back(StartOf(index));
    }
  }
  if (starts.empty()) {
    return;
  }
  Progress progress(heading_.target + ", judge", static_cast<int>(starts.size()), "starts", "without a way");
  int done = 0;
  int without_way = 0;
  progress.Show(done, without_way);
  JudgeStarts(scene_, starts, static_cast<int>(jobs_), [&](std::size_t i, const Judgement& judgement) {
    rows_->Add(indexes[i], judgement);
    without_way += judgement.has_way ? 0 : 1;
    progress.Show(++done, without_way);
  });
}

Figures Batch::FiguresOf(const std::string& case_name, int runs) const {
  Figures figures = Summarise(heading_, scenario_, rows(case_name), rows_->judgements(), runs);
  figures.width_px = scene_.camera.width_px;
  figures.height_px = scene_.camera.height_px;
  return figures;
}

// Deletes the run's folder if the run converged. Failed runs keep their pictures, except in a trial.
void Batch::Finish(const Task& task, int exit_code) {
  Row row;
  if (exit_code == config::kDone || exit_code == config::kGoalMissed) {
    row = MakeRow(task.index, StartOf(task.index), nlohmann::json::parse(Content(File(task, ".json"))));
  } else {
    row.index = task.index;
    row.start = StartOf(task.index);
    row.refused = exit_code >= 0;
    row.verdict =
        row.refused ? ReasonOf(Content(File(task, ".txt")))
                    : fmt::format("the simulator was killed, or did not end within {} s", kRunLimit.count());
    // A trial may ask for what cannot be, and for nothing else that the simulator refuses.
    const bool cannot_be = row.verdict.find("truth.") != std::string::npos ||
                           row.verdict.find("camera.lens") != std::string::npos;
    if (row.refused && !(task.truth->is_trial && cannot_be)) {
      throw std::runtime_error(fmt::format("run {}: {}", task.index, row.verdict));
    }
  }
  row.case_name = task.truth->name;
  row.truth = task.truth->truth;
  rows_->Add(row);
  RemoveOutput(task);
  if (row.converged || task.truth->is_trial) {
    std::error_code ignored;
    fs::remove_all(File(task, ""), ignored);
  }
}

}  // namespace fovea::atlas
