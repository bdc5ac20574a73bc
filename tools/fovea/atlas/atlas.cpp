// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/atlas.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <thread>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/printed_table.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "tools/fovea/atlas/batch.hpp"
#include "tools/fovea/atlas/figures.hpp"
#include "tools/fovea/atlas/files.hpp"
#include "tools/fovea/atlas/page.hpp"
#include "tools/fovea/atlas/progress.hpp"
#include "tools/fovea/atlas/seed.hpp"
#include "tools/fovea/atlas/starts_file.hpp"
#include "tools/fovea/atlas/views.hpp"
#include "tools/fovea/robustness/robustness.hpp"

namespace fovea {
namespace {

namespace fs = std::filesystem;

constexpr int kRuns = 1000;
constexpr int kRunsWithCases = 20;
constexpr int kRunsOfFindings = 300;
constexpr int kRunsOfLaws = 30;

// --set must not change what the sampler sets or relies on.
void CheckAssignments(const std::vector<std::string>& assignments) {
  for (const std::string& assignment : assignments) {
    for (const char* own : {"arm.q_start", "camera.enabled", "target.kind", "target.position",
                            "target.rpy_deg", "target.motion", "run.seed"}) {
      if (assignment.rfind(own, 0) == 0) {
        throw config::InputError(fmt::format("--set {}: the atlas sets {} itself", assignment, own));
      }
    }
  }
}

// The assignments of [truth] among --set, or the others.
std::vector<std::string> Assignments(const AtlasArguments& arguments, bool of_truth) {
  std::vector<std::string> assignments;
  std::copy_if(arguments.assignments.begin(), arguments.assignments.end(), std::back_inserter(assignments),
               [&](const std::string& assignment) { return robustness::IsTruth(assignment) == of_truth; });
  return assignments;
}

bool HasTruth(const AtlasArguments& arguments) {
  return !arguments.truth.empty() || !Assignments(arguments, true).empty();
}

int DrawOnly(const AtlasArguments& arguments) {
  atlas::Figures figures;
  figures.heading = HeadingOf(arguments, arguments.target, {});
  const atlas::Sampler sampler(
      atlas::LoadScene(arguments.target, atlas::SceneAssignments(figures.heading.assignments)));
  figures.scenario = atlas::ScenarioOf(arguments.target);
  figures.runs = RunsOf(arguments);
  for (int index = 0; index < figures.runs; ++index) {
    const atlas::Start start = sampler.Draw(figures.heading.seed, index);
    for (std::size_t i = 0; i < figures.rejections.size(); ++i) {
      figures.rejections[i] += start.rejections[i];
    }
  }
  fmt::print("{}", arguments.json ? atlas::DrawsAsJson(figures)
                                  : atlas::DrawsAsTable(figures, config::StyleOf(STDOUT_FILENO)));
  return config::kDone;
}

int MakeViews(const AtlasArguments& arguments) {
  const atlas::Heading heading = HeadingOf(arguments, arguments.target, {});
  const atlas::Scene scene = atlas::LoadScene(arguments.target, atlas::SceneAssignments(heading.assignments));
  const int pairs = RunsOf(arguments);
  atlas::CheckWritable(arguments.views);
  {
    atlas::Progress progress("views of " + arguments.target, pairs, "pairs", "draws refused");
    const auto show = [&progress](int done, int refused) { progress.Show(done, refused); };
    atlas::WriteFile(arguments.views, atlas::ViewsAsCsv(scene, heading.seed, pairs, show));
  }
  fmt::print("{}: {} pairs of views\n", arguments.views, pairs);
  return config::kDone;
}

// The options for wrong beliefs.
void AddTruth(CLI::App& app, AtlasArguments& arguments, CLI::Option* faults, CLI::Option* robust) {
  app.add_option(
         "--truth", arguments.truth,
         fmt::format("what is not as the servo believes: a shipped specification ({}) or the path of a .toml "
                     "with a section [truth]; --set with keys of [truth] adds to it or changes it",
                     fmt::join(robustness::ShippedSpecs(), ", ")))
      ->excludes(faults);
  CLI::Option* sizes = app.add_option("--truth-size", arguments.sizes,
                                      "sizes of all these differences, such as 0,0.5,1,2: runs at each size")
                           ->delimiter(',')
                           ->check(CLI::Range(0.0, 100.0))
                           ->excludes(faults)
                           ->excludes(robust);
  for (CLI::Option* option :
       {app.add_flag("--tornado", arguments.tornado, "each of these differences alone: which costs most"),
        app.add_flag("--margin", arguments.margin,
                     "as --tornado, and how large each may be, by bisection of its size")}) {
    option->excludes(faults)->excludes(robust)->excludes(sizes);
  }
  app.add_option("--alone", arguments.alone,
                 "with --tornado, --margin or --robustness: number of starts for each difference alone")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

}  // namespace

int JobsOf(const AtlasArguments& arguments) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return arguments.jobs > 0 ? arguments.jobs : std::max(cores, 1);
}

int RunsOf(const AtlasArguments& arguments) {
  const bool has_cases = arguments.robustness || arguments.tornado || arguments.margin;
  return arguments.runs.value_or(arguments.findings ? kRunsOfFindings
                                 : arguments.laws   ? kRunsOfLaws
                                 : has_cases        ? kRunsWithCases
                                                    : kRuns);
}

robustness::Spec TruthOf(const AtlasArguments& arguments) {
  const bool is_default = arguments.robustness && !HasTruth(arguments);
  return robustness::LoadSpec(is_default ? "uncertain" : arguments.truth, Assignments(arguments, true));
}

atlas::Heading HeadingOf(const AtlasArguments& arguments, const std::string& target,
                         const std::vector<std::string>& truth) {
  return {target,
          static_cast<std::uint64_t>(arguments.seed.value_or(atlas::JudgingSeed(kServoLibraryHash))),
          Assignments(arguments, false),
          kServoLibraryHash,
          truth,
          ""};
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
  CLI::Option* robust =
      kind->add_flag("--robustness", arguments.robustness,
                     "every target with wrong beliefs: each alone, all together, and how wrong they may be");
  CLI::Option* contact = kind->add_flag(
      "--contact", arguments.contact,
      "pushes while masses are wrong: false alarms and detected pushes, over the detector's threshold");
  CLI::Option* findings = kind->add_flag(
      "--findings", arguments.findings,
      "runs of ball-exciting: is what they find out about wrong beliefs true, and as sure as they say");
  CLI::Option* laws =
      kind->add_flag("--laws", arguments.laws,
                     "all visual laws from the same starts: the four canonical tasks, and random ones");
  kind->require_option(1);
  atlas
      ->add_option(
          "--runs", arguments.runs,
          fmt::format("number of random starts; default: {}; with --tornado, --margin or --robustness: {}; "
                      "with --findings, of runs: {}; with --laws, for each law: {}",
                      kRuns, kRunsWithCases, kRunsOfFindings, kRunsOfLaws))
      ->check(CLI::Range(1, 100000))
      ->excludes(faults);
  AddTruth(*atlas, arguments, faults, robust);
  for (const char* option : {"--runs", "--truth", "--truth-size", "--tornado", "--margin"}) {
    atlas->get_option(option)->excludes(contact);
  }
  for (const char* option : {"--truth", "--truth-size", "--tornado", "--margin"}) {
    atlas->get_option(option)->excludes(findings)->excludes(laws);
  }
  atlas
      ->add_option("--only", arguments.only,
                   "with --faults: only cells whose name (such as ball.approach.torque_loss.severe) contains "
                   "this; with --robustness: only this target; with --contact: only this motion; "
                   "with --laws: only this law; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->excludes(target);
  atlas->add_option("-j,--jobs", arguments.jobs, "number of runs in parallel; default: one for each core")
      ->check(CLI::Range(1, 256));
  atlas
      ->add_option(
          "--seed", arguments.seed,
          fmt::format(
              "seed of the starts and runs. Seeds below {} are for tuning. Default: a seed derived from "
              "the servo's code, so that nobody has tuned on its starts; with --faults, --contact or "
              "--findings: 1",
              atlas::kFirstJudgingSeed))
      ->check(CLI::Range(0, 2147483647));
  atlas
      ->add_option("--set", arguments.assignments,
                   "key=value for every run, overrides the scenario; may be repeated")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->excludes(faults)
      ->excludes(contact)
      ->excludes(findings);
  atlas->add_option("--out", arguments.out,
                    "folder for the files; default: out/atlas-<target>, out/atlas-faults, "
                    "out/atlas-robustness, out/atlas-contact, out/atlas-findings or "
                    "out/atlas-laws");
  atlas->add_flag("--resume", arguments.resume, "keep the finished runs in the folder, do the rest");
  CLI::Option* draw_only =
      atlas->add_flag("--draw-only", arguments.draw_only,
                      "draw the starts without running them; print how many are rejected, and why");
  // E.g. an unset variable of a shell.
  const CLI::Validator named([](const std::string& file) { return file.empty() ? "no file is named" : ""; },
                             "FILE");
  CLI::Option* views =
      atlas
          ->add_option(
              "--make-views", arguments.views,
              "run nothing, but write random starts to this file, for --starts: pairs of camera poses, in "
              "the ranges of a public benchmark")
          ->check(named)
          ->excludes(draw_only);
  for (CLI::Option* without_runs : {draw_only, views}) {
    without_runs->needs(target);
    for (const char* option : {"--truth", "--truth-size", "--tornado", "--margin"}) {
      without_runs->excludes(atlas->get_option(option));
    }
  }
  for (const char* option : {"--out", "--resume"}) {
    views->excludes(atlas->get_option(option));
  }
  CLI::Option* starts =
      atlas
          ->add_option("--starts", arguments.starts,
                       "file of starts, CSV or JSON, instead of random ones: q1, q2, ... or camera_x, ..., "
                       "camera_yaw; target_x, ..., target_yaw; goal_x, ..., goal_yaw; seed")
          ->check(named)
          ->needs(target);
  for (const char* option :
       {"--runs", "--truth-size", "--tornado", "--margin", "--draw-only", "--make-views"}) {
    starts->excludes(atlas->get_option(option));
  }
  CLI::Option* json =
      atlas->add_flag("--json", arguments.json, "print atlas.json instead of the table")->excludes(views);
  atlas
      ->add_flag("--markdown", arguments.markdown,
                 "with --faults, --robustness, --contact or --findings: print the page sim/FAULTS.md, "
                 "sim/ROBUSTNESS.md, sim/CONTACT.md or sim/FINDINGS.md")
      ->excludes(target)
      ->excludes(json);
  return atlas;
}

int Atlas(const AtlasArguments& arguments) {
  if (arguments.faults) {
    return FaultAtlas(arguments);
  }
  if (arguments.contact) {
    return ContactAtlas(arguments);
  }
  if (arguments.findings) {
    return FindingsAtlas(arguments);
  }
  if (arguments.laws) {
    return LawsAtlas(arguments);
  }
  CheckAssignments(arguments.assignments);
  if (arguments.draw_only) {
    return DrawOnly(arguments);
  }
  if (!arguments.views.empty()) {
    return MakeViews(arguments);
  }
  if (arguments.robustness || arguments.tornado || arguments.margin || !arguments.sizes.empty()) {
    return RobustnessAtlas(arguments);
  }
  const atlas::AtlasPage maker(config::ShareFolder() / "report");
  const fs::path out =
      arguments.out.empty() ? fs::path("out") / ("atlas-" + arguments.target) : fs::path(arguments.out);
  atlas::Heading heading = HeadingOf(arguments, arguments.target, {});
  std::vector<atlas::Start> given;
  if (!arguments.starts.empty()) {
    heading.starts = atlas::HashOfFile(arguments.starts);
    given = atlas::ReadStarts(
        arguments.starts, atlas::LoadScene(arguments.target, atlas::SceneAssignments(heading.assignments)));
  }
  const std::optional<robustness::Spec> spec =
      HasTruth(arguments) ? std::optional(TruthOf(arguments)) : std::nullopt;
  const atlas::Case truth{"", spec ? robustness::Scaled(*spec, 1.0) : std::vector<std::string>(), false};
  heading.truth = truth.truth;
  atlas::Batch batch(heading, out, JobsOf(arguments), arguments.resume, given);
  if (spec) {
    batch.Try(truth, spec->name);
  }
  const int runs = given.empty() ? RunsOf(arguments) : static_cast<int>(given.size());
  {
    atlas::Progress progress("atlas " + arguments.target, runs);
    batch.Execute({truth}, runs, progress);
  }
  batch.JudgeFailures({truth}, runs);
  const atlas::Figures figures = batch.FiguresOf(truth.name, runs);
  atlas::WriteFile(out / "atlas.json", atlas::ToJson(figures));
  atlas::WriteFile(out / "atlas.html", maker.Make(figures, batch.rows()));
  if (arguments.json) {
    fmt::print("{}", atlas::ToJson(figures));
  } else {
    const config::TextStyle style = config::StyleOf(STDOUT_FILENO);
    config::PrintedTable page(style);
    page.WholeRow("page", (out / "atlas.html").string());
    fmt::print("{}{}", atlas::ToTable(figures, style), page.text());
  }
  return figures.ReachedGoal() ? config::kDone : config::kGoalMissed;
}

}  // namespace fovea
