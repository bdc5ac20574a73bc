// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/atlas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/folder_lock.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/config/target_keys.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tools/bench/common/shell.hpp"
#include "tools/fovea/atlas/children.hpp"
#include "tools/fovea/atlas/figures.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/atlas/page.hpp"
#include "tools/fovea/atlas/progress.hpp"
#include "tools/fovea/atlas/rows.hpp"
#include "tools/fovea/atlas/sampler.hpp"
#include "tools/fovea/atlas/seed.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;
using atlas::Row;

constexpr std::chrono::seconds kRunLimit{900};  // of wall time; a run takes some seconds

const char* ScenarioOf(const std::string& target) { return target == "sphere" ? "ball" : target.c_str(); }

atlas::Sampler MakeSampler(const std::string& target) {
  config::TargetSettings settings;
  settings.kind = target;
  return {robots::LoadRobot(config::ShareFolder() / "robots" / "panda.toml").model,
          config::MakeTarget(settings)};
}

// --set must not change what the sampler sets or relies on.
void CheckAssignments(const std::vector<std::string>& assignments) {
  for (const std::string& assignment : assignments) {
    for (const char* own : {"arm.model", "arm.q_start", "camera.enabled", "camera.width_px",
                            "camera.height_px", "camera.hfov_deg", "camera.f_", "camera.c_", "camera.mount_",
                            "target.", "servo.goal", "run.seed"}) {
      if (assignment.rfind(own, 0) == 0) {
        throw config::InputError(fmt::format("--set {}: the atlas sets {} itself", assignment, own));
      }
    }
  }
}

atlas::Heading HeadingOf(const AtlasArguments& arguments) {
  return {arguments.target,
          static_cast<std::uint64_t>(arguments.seed.value_or(atlas::JudgingSeed(kServoLibraryHash))),
          arguments.assignments, kServoLibraryHash};
}

int DrawOnly(const AtlasArguments& arguments) {
  const atlas::Sampler sampler = MakeSampler(arguments.target);
  atlas::Figures figures;
  figures.heading = HeadingOf(arguments);
  figures.scenario = ScenarioOf(arguments.target);
  figures.runs = arguments.runs;
  for (int index = 0; index < arguments.runs; ++index) {
    const atlas::Start start = sampler.Draw(figures.heading.seed, index);
    for (std::size_t i = 0; i < figures.rejections.size(); ++i) {
      figures.rejections[i] += start.rejections[i];
    }
  }
  fmt::print("{}", arguments.json ? atlas::DrawsAsJson(figures)
                                  : atlas::DrawsAsTable(figures, config::StyleOf(STDOUT_FILENO)));
  return config::kDone;
}

class AtlasRun {
 public:
  explicit AtlasRun(const AtlasArguments& arguments)
      : arguments_(arguments),
        heading_(HeadingOf(arguments)),
        scenario_(ScenarioOf(arguments_.target)),
        simulator_(bench::SimulatorBeside("fovea atlas")),
        sampler_(MakeSampler(arguments.target)),
        page_(config::ShareFolder() / "report"),
        out_(arguments.out.empty() ? fs::path("out") / ("atlas-" + arguments.target)
                                   : fs::path(arguments.out)) {
    std::error_code error;
    fs::create_directories(out_ / "runs", error);
    if (error) {
      throw config::InputError(out_.string() + ": cannot create this folder");
    }
    lock_.emplace(out_);
    rows_.emplace(out_ / "rows.jsonl", heading_, arguments.resume);
  }

  atlas::Figures Execute() {
    const auto jobs = static_cast<std::size_t>(JobsOf(arguments_));
    atlas::Progress progress("atlas " + arguments_.target, arguments_.runs);
    int next = 0;
    for (;;) {
      for (; next < arguments_.runs && children_.running() < jobs; ++next) {
        if (rows_->rows().count(next) == 0) {
          Begin(next);
        }
      }
      if (children_.running() == 0) {
        break;
      }
      Finish(children_.WaitForOne());
      const auto& rows = rows_->rows();
      progress.Show(static_cast<int>(std::distance(rows.begin(), rows.lower_bound(arguments_.runs))),
                    static_cast<int>(std::count_if(rows.begin(), rows.lower_bound(arguments_.runs),
                                                   [](const auto& row) { return !row.second.converged; })));
    }
    progress.End();
    const atlas::Figures figures = atlas::Summarise(heading_, scenario_, rows_->rows(), arguments_.runs);
    atlas::WriteFile(out_ / "atlas.json", atlas::ToJson(figures));
    atlas::WriteFile(out_ / "atlas.html", page_.Make(figures, rows_->rows()));
    return figures;
  }

  [[nodiscard]] const fs::path& out() const { return out_; }

 private:
  [[nodiscard]] fs::path Folder(int index) const { return out_ / "runs" / fmt::format("{:04}", index); }
  [[nodiscard]] fs::path Printed(int index) const { return out_ / "runs" / fmt::format("{:04}.json", index); }
  [[nodiscard]] fs::path Said(int index) const { return out_ / "runs" / fmt::format("{:04}.txt", index); }

  void Begin(int index) {
    const atlas::Start& start = starts_[index] = sampler_.Draw(heading_.seed, index);
    std::vector<std::string> command{
        simulator_,    "run",    scenario_, "--seed",     std::to_string(start.run_seed),
        "--no-report", "--json", "--out",   Folder(index)};
    for (const std::string& assignment : atlas::AssignmentsOf(heading_, start)) {
      command.emplace_back("--set");
      command.push_back(assignment);
    }
    children_.Start(index, command, Printed(index), Said(index), kRunLimit);
  }

  // Deletes the run's folder if the run converged. Failed runs keep their pictures.
  void Finish(const atlas::Children::Ended& ended) {
    const int index = ended.tag;
    Row row;
    if (ended.exit_code == config::kDone || ended.exit_code == config::kGoalMissed) {
      row = atlas::MakeRow(index, starts_[index], nlohmann::json::parse(atlas::Content(Printed(index))));
    } else if (ended.exit_code < 0) {
      row.index = index;
      row.start = starts_[index];
      row.verdict = fmt::format("the simulator was killed, or did not end within {} s", kRunLimit.count());
    } else {
      throw std::runtime_error(
          fmt::format("run {}: {}", index, atlas::FirstLine(atlas::Content(Said(index)))));
    }
    rows_->Add(row);
    starts_.erase(index);
    std::error_code ignored;
    fs::remove(Printed(index), ignored);
    fs::remove(Said(index), ignored);
    if (row.converged) {
      fs::remove_all(Folder(index), ignored);
    }
  }

  const AtlasArguments& arguments_;
  const atlas::Heading heading_;
  const std::string scenario_;
  const fs::path simulator_;
  const atlas::Sampler sampler_;
  const atlas::AtlasPage page_;
  const fs::path out_;
  std::optional<config::FolderLock> lock_;
  std::optional<atlas::RowFile> rows_;
  std::map<int, atlas::Start> starts_;  // of the runs in progress
  atlas::Children children_;
};

}  // namespace

int JobsOf(const AtlasArguments& arguments) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return arguments.jobs > 0 ? arguments.jobs : std::max(cores / 2, 1);
}

CLI::App* AddAtlas(CLI::App& app, AtlasArguments& arguments) {
  CLI::App* atlas = app.add_subcommand(
      "atlas", "simulate many runs: the convergence rate from random starts, or the outcome of every fault");
  CLI::Option_group* kind = atlas->add_option_group("kind of atlas");
  CLI::Option* target = kind->add_option("--target", arguments.target, "random starts with this target")
                            ->check(CLI::IsMember(std::vector<std::string>(features::kTargetNames.begin(),
                                                                           features::kTargetNames.end())));
  CLI::Option* faults = kind->add_flag("--faults", arguments.faults,
                                       "every fault, mild to extreme, in every kind of run, at every stage");
  kind->require_option(1);
  atlas->add_option("--runs", arguments.runs, "number of random starts")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str()
      ->excludes(faults);
  atlas
      ->add_option("--only", arguments.only,
                   "with --faults: only cells whose name (such as ball.approach.torque_loss.severe) contains "
                   "this; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->excludes(target);
  atlas
      ->add_option("-j,--jobs", arguments.jobs,
                   "number of runs in parallel; default: one for every two cores")
      ->check(CLI::Range(1, 256));
  atlas
      ->add_option(
          "--seed", arguments.seed,
          fmt::format(
              "seed of the starts and runs. Seeds below {} are for tuning. Default: a seed derived from "
              "the servo's code, so that nobody has tuned on its starts; with --faults: 1",
              atlas::kFirstJudgingSeed))
      ->check(CLI::Range(0, 2147483647));
  atlas
      ->add_option("--set", arguments.assignments,
                   "key=value for every run, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->excludes(faults);
  atlas->add_option("--out", arguments.out,
                    "folder for the files; default: out/atlas-<target> or out/atlas-faults");
  atlas->add_flag("--resume", arguments.resume, "keep the finished runs in the folder, do the rest");
  atlas
      ->add_flag("--draw-only", arguments.draw_only,
                 "draw the starts without running them; print how many are rejected, and why")
      ->excludes(faults);
  CLI::Option* json = atlas->add_flag("--json", arguments.json, "print atlas.json instead of the table");
  atlas->add_flag("--markdown", arguments.markdown, "with --faults: print the page sim/FAULTS.md")
      ->excludes(target)
      ->excludes(json);
  return atlas;
}

int Atlas(const AtlasArguments& arguments) {
  if (arguments.faults) {
    return FaultAtlas(arguments);
  }
  CheckAssignments(arguments.assignments);
  if (arguments.draw_only) {
    return DrawOnly(arguments);
  }
  AtlasRun run(arguments);
  const atlas::Figures figures = run.Execute();
  if (arguments.json) {
    fmt::print("{}", atlas::ToJson(figures));
  } else {
    const config::TextStyle style = config::StyleOf(STDOUT_FILENO);
    config::PrintedTable page(style);
    page.WholeRow("page", (run.out() / "atlas.html").string());
    fmt::print("{}{}", atlas::ToTable(figures, style), page.text());
  }
  return figures.ReachedGoal() ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
