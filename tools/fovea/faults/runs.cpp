// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/faults/runs.hpp"

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>
#include <utility>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "tools/bench/common/shell.hpp"
#include "tools/fovea/atlas/files.hpp"

namespace fovea::matrix {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::chrono::seconds kRunLimit{900};  // of wall time; a run takes some seconds

// Whether `row` is the result of `job` with this servo.
bool IsOf(const json& row, const Job& job, int seed) {
  return row.at("servo") == kServoLibraryHash && row.at("seed") == job.seed.value_or(seed) &&
         row.at("scenario") == job.scenario &&
         row.at("set").get<std::vector<std::string>>() == job.assignments;
}

}  // namespace

std::string CommandOf(const Job& job, int seed) {
  std::string command = fmt::format("fovea-sim run {} --seed {}", job.scenario, job.seed.value_or(seed));
  for (const std::string& assignment : job.assignments) {
    command += " --set " + bench::Quoted(assignment);
  }
  return command;
}

Runs::Runs(const fs::path& folder, int seed, int jobs, bool resume, RunKind kind)
    : kind_(std::move(kind)),
      folder_(folder),
      seed_(seed),
      jobs_(static_cast<std::size_t>(jobs)),
      workers_(bench::SimulatorBeside(kind_.program)) {
  std::error_code error;
  fs::create_directories(folder_ / "runs", error);
  if (error) {
    throw config::InputError(folder_.string() + ": cannot create this folder");
  }
  lock_.emplace(folder_);
  if (resume) {
    Read();
  }
  stream_.open(folder_ / "rows.jsonl", std::ios::binary | std::ios::trunc);
  for (const auto& [name, row] : rows_) {
    stream_ << row.dump() << '\n';
  }
  stream_ << std::flush;
  if (!stream_) {
    throw config::InputError((folder_ / "rows.jsonl").string() + ": cannot be written");
  }
}

// Drops an incomplete last line.
void Runs::Read() {
  std::istringstream lines(atlas::Content(folder_ / "rows.jsonl"));
  for (std::string line; std::getline(lines, line);) {
    const json row = json::parse(line, nullptr, /*allow_exceptions=*/false);
    if (row.is_object() && row.contains("run")) {
      rows_[row.at("run").get<std::string>()] = row;
    }
  }
}

fs::path Runs::File(const std::string& name, const char* ending) const {
  return folder_ / "runs" / (name + ending);
}

void Runs::Execute(const std::vector<Job>& jobs, atlas::Progress& progress) {
  std::vector<const Job*> left;
  int done = 0;
  for (const Job& job : jobs) {
    const auto row = rows_.find(job.name);
    if (row == rows_.end() || !IsOf(row->second, job, seed_)) {
      left.push_back(&job);
    } else {
      ++done;
    }
  }
  int broken = 0;
  std::size_t next = 0;
  for (;;) {
    for (; next < left.size() && workers_.running() < jobs_; ++next) {
      const Job& job = *left[next];
      std::vector<std::string> command{job.scenario, "--seed", std::to_string(job.seed.value_or(seed_)),
                                       "--json",     "--out",  File(job.name, "")};
      // One renderer keeps one core busy.
      for (const char* option : {"--pictures", "failed", "--renderers", "1"}) {
        command.emplace_back(option);
      }
      if (!kind_.keeps_log) {
        command.emplace_back("--no-report");
      }
      for (const std::string& assignment : job.assignments) {
        command.emplace_back("--set");
        command.push_back(assignment);
      }
      workers_.Start(static_cast<int>(next), command, File(job.name, ".json"), File(job.name, ".txt"),
                     kRunLimit);
    }
    if (workers_.running() == 0) {
      return;
    }
    const atlas::Workers::Ended ended = workers_.WaitForOne();
    const Job& job = *left[static_cast<std::size_t>(ended.tag)];
    Finish(job, ended.exit_code);
    broken += SummaryOf(job.name).is_null() ? 1 : 0;
    progress.Show(++done, broken);
  }
}

void Runs::Finish(const Job& job, int exit_code) {
  json row{{"run", job.name},
           {"scenario", job.scenario},
           {"set", job.assignments},
           {"seed", job.seed.value_or(seed_)},
           {"servo", kServoLibraryHash},
           {"summary", nullptr}};
  if (exit_code == config::kDone || exit_code == config::kGoalMissed) {
    const json summary = json::parse(atlas::Content(File(job.name, ".json")));
    row["summary"] = kind_.excerpt(job, summary, File(job.name, ""));
  } else if (exit_code >= 0) {
    throw std::runtime_error(
        fmt::format("{}: {}", job.name, atlas::ReasonOf(atlas::Content(File(job.name, ".txt")))));
  }
  stream_ << row.dump() << '\n' << std::flush;
  if (!stream_) {
    throw std::runtime_error((folder_ / "rows.jsonl").string() + ": cannot be written");
  }
  rows_[job.name] = std::move(row);
  std::error_code ignored;
  fs::remove(File(job.name, ".json"), ignored);
  fs::remove(File(job.name, ".txt"), ignored);
  fs::remove_all(File(job.name, ""), ignored);
}

const json& Runs::SummaryOf(const std::string& name) const { return rows_.at(name).at("summary"); }

}  // namespace fovea::matrix
