// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/contact/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "firmware/core/config/safety_config.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tools/fovea/faults/runs.hpp"

namespace fovea::contact {
namespace {

using matrix::Job;
using nlohmann::json;

constexpr int kQuietDraws = 6;
constexpr int kPushDraws = 3;      // of these draws, for each motion and place
constexpr double kSampleS = 0.05;  // of the postures that a quiet run keeps
constexpr double kAfterS = 0.1;    // a run goes on after its push

// A run, and its push.
struct PlannedRun {
  Job job;
  bool is_right = true;
  std::size_t force = 0;
  Push push;
};

std::string QuietName(const Motion& motion, bool is_right, int draw) {
  return fmt::format("{}.{}{}.quiet", motion.name, is_right ? "right" : "wrong", draw);
}

json QuietRow(const Recording& recording) {
  const QuietRun run = JudgeQuiet(recording);
  json row{{"moving_s", run.moving_s}, {"alarms", run.alarms}, {"q", json::array()}};
  for (const WatchedTick& tick : recording.ticks) {
    if (tick.t_s >= kSampleS * static_cast<double>(row["q"].size())) {
      row["q"].push_back(tick.q);
    }
  }
  return row;
}

json PushedRow(const Recording& recording, double from_s) {
  const PushedRun run = JudgePushed(recording, from_s, from_s + kPushS);
  json row{{"after_ms", json::array()},
           {"other_guard_ms", run.other_guard_ms ? json(*run.other_guard_ms) : json(nullptr)}};
  for (const auto& detector : run.after_ms) {
    json times = json::array();
    for (const auto& after_ms : detector) {
      times.push_back(after_ms ? json(*after_ms) : json(nullptr));
    }
    row["after_ms"].push_back(times);
  }
  return row;
}

QuietRun QuietOf(const json& row) {
  QuietRun run;
  run.moving_s = row.at("moving_s");
  row.at("alarms").get_to(run.alarms);
  return run;
}

PushedRun PushedOf(const json& row) {
  PushedRun run;
  for (std::size_t d = 0; d < kDetectors.size(); ++d) {
    for (std::size_t i = 0; i < kNumThresholds; ++i) {
      if (const json& after_ms = row.at("after_ms").at(d).at(i); !after_ms.is_null()) {
        run.after_ms[d][i] = after_ms.get<double>();
      }
    }
  }
  if (!row.at("other_guard_ms").is_null()) {
    run.other_guard_ms = row.at("other_guard_ms").get<double>();
  }
  return run;
}

// Draws and runs. The draws do not depend on which motions are asked for.
class Planner {
 public:
  Planner(const StudyOptions& options, const model::ArmModel& arm) : options_(options), arm_(arm) {}

  // All runs of a motion without a push.
  void PlanQuiet(const Motion& motion) {
    AddQuiet(motion, true, 0);
    for (int draw = 0; draw < kQuietDraws; ++draw) {
      AddQuiet(motion, false, draw);
    }
  }
  // All with one, from the postures of those without.
  void PlanPushed(const Motion& motion, const matrix::Runs& runs) {
    for (const Place place : kPlaces) {
      if (place == Place::kHand) {
        AddPushed(motion, true, 0, place, runs);
      }
      for (int draw = 0; draw < kPushDraws; ++draw) {
        AddPushed(motion, false, draw, place, runs);
      }
    }
  }
  [[nodiscard]] const std::vector<PlannedRun>& quiet() const { return quiet_; }
  [[nodiscard]] const std::vector<PlannedRun>& pushed() const { return pushed_; }

 private:
  [[nodiscard]] std::mt19937_64 RandomOf(const std::string& name) const {
    std::seed_seq seeds(name.begin(), name.end());
    std::mt19937_64 random(seeds);
    random.discard(static_cast<unsigned long long>(options_.seed));
    return random;
  }
  [[nodiscard]] std::vector<std::string> SettingsOf(const Motion& motion, bool is_right, int draw) const {
    std::vector<std::string> settings = motion.assignments;
    for (const char* limit : {"torque", "sudden"}) {
      settings.push_back(fmt::format("safety.contact_{}_fraction={}", limit, kOff));
    }
    if (!is_right) {
      std::mt19937_64 random = RandomOf(QuietName(motion, is_right, draw));
      const std::vector<std::string> wrong = WrongBeliefs(random, draw, arm_.num_joints);
      settings.insert(settings.end(), wrong.begin(), wrong.end());
    }
    return settings;
  }
  void AddQuiet(const Motion& motion, bool is_right, int draw) {
    PlannedRun run;
    run.is_right = is_right;
    run.job = {QuietName(motion, is_right, draw), motion.scenario, SettingsOf(motion, is_right, draw)};
    run.job.assignments.push_back(fmt::format("run.duration_s={}", motion.quiet_s));
    quiet_.push_back(run);
  }
  void AddPushed(const Motion& motion, bool is_right, int draw, Place place, const matrix::Runs& runs) {
    const std::string quiet = QuietName(motion, is_right, draw);
    std::mt19937_64 random = RandomOf(quiet + Name(place));
    const Push push = DrawPush(random, place, motion);
    const json& postures = runs.SummaryOf(quiet).at("q");
    const auto at = static_cast<std::size_t>(push.from_s / kSampleS);
    if (at >= postures.size()) {
      throw std::runtime_error(fmt::format("{}: the run ended before {} s", quiet, push.from_s));
    }
    for (std::size_t k = 0; k < kForces.size(); ++k) {
      PlannedRun run;
      run.is_right = is_right;
      run.force = k;
      run.push = push;
      run.job = {fmt::format("{}.{}{}.{}.{:g}N", motion.name, is_right ? "right" : "wrong", draw, Name(place),
                             kForces.at(k)),
                 motion.scenario, SettingsOf(motion, is_right, draw)};
      for (const std::string& setting :
           AssignmentsOf(push, kForces.at(k), arm_, postures.at(at).get<std::vector<double>>())) {
        run.job.assignments.push_back(setting);
      }
      run.job.assignments.push_back(fmt::format("run.duration_s={:.3f}", push.from_s + kPushS + kAfterS));
      pushed_.push_back(run);
    }
  }

  static constexpr int kOff = 1'000'000;  // no torque is this large

  const StudyOptions& options_;
  const model::ArmModel& arm_;
  std::vector<PlannedRun> quiet_;
  std::vector<PlannedRun> pushed_;
};

std::vector<Job> JobsIn(const std::vector<PlannedRun>& runs) {
  std::vector<Job> jobs;
  jobs.reserve(runs.size());
  for (const PlannedRun& run : runs) {
    jobs.push_back(run.job);
  }
  return jobs;
}

std::vector<const Motion*> MotionsOf(const std::vector<std::string>& only) {
  std::vector<const Motion*> chosen;
  std::vector<std::string> names;
  for (const Motion& motion : Motions()) {
    names.emplace_back(motion.name);
    if (only.empty() || std::find(only.begin(), only.end(), motion.name) != only.end()) {
      chosen.push_back(&motion);
    }
  }
  for (const std::string& name : only) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw config::InputError(
          fmt::format("--only {}: no such motion; allowed are {}", name, fmt::join(names, ", ")));
    }
  }
  return chosen;
}

const json& RowOf(const matrix::Runs& runs, const Job& job) {
  const json& row = runs.SummaryOf(job.name);
  if (row.is_null()) {
    throw std::runtime_error(job.name + ": the simulator did not finish");
  }
  return row;
}

}  // namespace

Study RunStudy(const StudyOptions& options) {
  const std::vector<const Motion*> motions = MotionsOf(options.only);
  const model::ArmModel arm = robots::LoadRobot(config::ShareFolder() / "robots" / "panda.toml").model;
  Planner planner(options, arm);
  std::map<std::string, double> from_s;  // of the runs with a push
  const matrix::RunKind kind{
      .program = "fovea atlas --contact",
      .keeps_log = true,
      .excerpt = [&from_s](const Job& job, const json&, const std::filesystem::path& folder) {
        const Recording recording = ReadRecording(folder, SuddenWeight(config::SafetyConfig{}));
        const auto push = from_s.find(job.name);
        return push == from_s.end() ? QuietRow(recording) : PushedRow(recording, push->second);
      }};
  matrix::Runs runs(options.out, options.seed, options.jobs, options.resume, kind);
  for (const Motion* motion : motions) {
    planner.PlanQuiet(*motion);
  }
  {
    atlas::Progress progress("without a push", static_cast<int>(planner.quiet().size()));
    runs.Execute(JobsIn(planner.quiet()), progress);
  }
  for (const Motion* motion : motions) {
    planner.PlanPushed(*motion, runs);
  }
  for (const PlannedRun& run : planner.pushed()) {
    from_s[run.job.name] = run.push.from_s;
  }
  {
    atlas::Progress progress("pushes", static_cast<int>(planner.pushed().size()));
    runs.Execute(JobsIn(planner.pushed()), progress);
  }
  Study study;
  const config::SafetyConfig safety;
  study.seed = options.seed;
  study.runs = static_cast<int>(planner.quiet().size() + planner.pushed().size());
  study.threshold = NearestThreshold(safety.contact_torque_fraction);
  study.sudden_weight = SuddenWeight(safety);
  study.command = matrix::CommandOf(planner.pushed().back().job, options.seed);
  for (const Motion* motion : motions) {
    study.motions.emplace_back(motion->name);
  }
  for (const PlannedRun& run : planner.quiet()) {
    (run.is_right ? study.right : study.wrong).quiet.push_back(QuietOf(RowOf(runs, run.job)));
  }
  for (const PlannedRun& run : planner.pushed()) {
    (run.is_right ? study.right : study.wrong)
        .pushed.at(static_cast<std::size_t>(run.push.place))
        .at(run.force)
        .push_back(PushedOf(RowOf(runs, run.job)));
  }
  return study;
}

bool IsGood(const Study& study) {
  const auto& hardest = study.wrong.pushed.at(static_cast<std::size_t>(Place::kHand)).back();
  const Detection detection = Detect(hardest, Detector::kBoth, study.threshold);
  return CountAlarms(study.wrong.quiet, Detector::kBoth, study.threshold).alarms == 0 &&
         CountAlarms(study.right.quiet, Detector::kBoth, study.threshold).alarms == 0 &&
         detection.detected + detection.by_others == detection.pushes;
}

}  // namespace fovea::contact
