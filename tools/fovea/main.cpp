// SPDX-License-Identifier: Apache-2.0
// The program fovea: reports, replays and comparisons of recorded runs, atlases of simulated runs, gains, arm
// models, features, detection and calibration.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/guard_table.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/report/report.hpp"
#include "tools/fovea/atlas/atlas.hpp"
#include "tools/fovea/calibrate/calibrate.hpp"
#include "tools/fovea/compare/compare.hpp"
#include "tools/fovea/detect/detect.hpp"
#include "tools/fovea/features/features.hpp"
#include "tools/fovea/gains/gains.hpp"
#include "tools/fovea/live/live.hpp"
#include "tools/fovea/model/model.hpp"
#include "tools/fovea/replay/replay.hpp"

namespace {

using namespace fovea;

struct ReportArguments {
  std::vector<std::string> logs;
  std::string out;
};

// A report goes beside its log, a comparison of two runs to the current folder.
std::filesystem::path DefaultOut(const std::vector<std::string>& logs) {
  if (logs.size() > 1) {
    return "comparison.html";
  }
  const std::filesystem::path log = logs.front();
  return (std::filesystem::is_directory(log) ? log : log.parent_path()) / "report.html";
}

int Report(const ReportArguments& arguments) {
  std::vector<report::RunData> runs;
  for (const std::string& log : arguments.logs) {
    runs.push_back(report::ReadRun(flight::LogIn(log)));
    if (!runs.back().complete) {
      fmt::print(stderr, "fovea: {}; the report shows the readable part\n", runs.back().why_incomplete);
    }
  }
  const std::string page = report::ReportPage(config::ShareFolder() / "report").Make(runs);
  const std::filesystem::path out =
      arguments.out.empty() ? DefaultOut(arguments.logs) : std::filesystem::path(arguments.out);
  std::ofstream stream(out, std::ios::binary | std::ios::trunc);
  stream << page;
  stream.close();
  if (!stream) {
    std::error_code ignored;
    std::filesystem::remove(out, ignored);
    throw std::runtime_error(out.string() + ": cannot be written");
  }
  fmt::print("{}\n", out.string());
  return config::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Fovea's tools for logs, gains, arm models, image features, detection and calibration."};
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("fovea {} {}", kVersion, kGitRevision));
  app.footer(
      "Examples:\n"
      "  fovea report out/ball\n"
      "  fovea report out/ball/log.mcap --out ball.html\n"
      "  fovea report out/slow out/fast --out comparison.html\n"
      "  fovea replay out/ball\n"
      "  fovea compare out/ball\n"
      "  fovea gains --mass 16 --damping 16 --stiffness 4 --closed-loop-stiffness 16\n"
      "  fovea model panda\n"
      "  fovea features --target triangle --pose 0,0,0.4,1,0,0,0\n"
      "  fovea atlas --target sphere --runs 200 --jobs 2\n"
      "  fovea atlas --faults --jobs 2\n"
      "  fovea detect --target circle photo.png\n"
      "  fovea calibrate intrinsics boards/ --out camera.toml\n"
      "Exit: 0 done, 1 an atlas missed its goal or a replay differs, 2 wrong usage or input.");

  ReportArguments arguments;
  CLI::App* report = app.add_subcommand("report", "write the HTML report of a log, or compare two logs");
  report->add_option("log", arguments.logs, "a log.mcap, or the folder of a run; one or two")
      ->required()
      ->expected(1, 2);
  report->add_option("--out", arguments.out,
                     "the file to write; default: report.html beside the log, or comparison.html for two");

  ReplayArguments replay_arguments;
  const CLI::App* replay = AddReplay(app, replay_arguments);
  CompareArguments compare_arguments;
  const CLI::App* compare = AddCompare(app, compare_arguments);
  GainsArguments gains_arguments;
  const CLI::App* gains = AddGains(app, gains_arguments);
  DetectArguments detect_arguments;
  const CLI::App* detect = AddDetect(app, detect_arguments);
  AtlasArguments atlas_arguments;
  const CLI::App* atlas = AddAtlas(app, atlas_arguments);
  CalibrateArguments calibrate_arguments;
  const CLI::App* calibrate = AddCalibrate(app, calibrate_arguments);
  LiveArguments live_arguments;
  const CLI::App* live = AddLive(app, live_arguments);
  ModelArguments model_arguments;
  const CLI::App* model = AddModel(app, model_arguments);
  FeaturesArguments features_arguments;
  const CLI::App* features = AddFeatures(app, features_arguments);
  const CLI::App* guards = app.add_subcommand("guards", "print the table of guards in firmware/GUARDS.md");

  return config::RunProgram("fovea", app, argc, argv, [&] {
    if (guards->parsed()) {
      fmt::print("{}", config::GuardTableAsMarkdown());
      return config::kDone;
    }
    if (replay->parsed()) {
      return Replay(replay_arguments);
    }
    if (compare != nullptr && compare->parsed()) {
      return Compare(compare_arguments);
    }
    if (atlas->parsed()) {
      return Atlas(atlas_arguments);
    }
    if (detect->parsed()) {
      return Detect(detect_arguments);
    }
    if (calibrate->parsed()) {
      return Calibrate(*calibrate, calibrate_arguments);
    }
    if (live->parsed()) {
      return Live(live_arguments);
    }
    if (model->parsed()) {
      return Model(model_arguments);
    }
    if (features->parsed()) {
      return Features(features_arguments);
    }
    return gains->parsed() ? Gains(gains_arguments) : Report(arguments);
  });
}
