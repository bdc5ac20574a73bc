// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/run/run_book.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/film/complete_film.hpp"
#include "firmware/host/film/target_curve.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/log/picture_messages.hpp"
#include "firmware/host/recording/log/record_hash.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"

namespace fovea::run {
namespace {

const std::string kLog = "log.mcap";
const std::string kFilm = "camera.mp4";
const std::string kReport = "report.html";

log::RunLogConfig LogConfig(const RunFacts& facts, const RunBookOptions& options,
                            const std::filesystem::path& path) {
  log::RunLogConfig out;
  out.path = path;
  out.library = fmt::format("fovea {}", kVersion);
  out.arm = facts.servo.arm;
  out.frames = facts.frames;
  out.may_drop = options.may_drop;
  out.ring = options.ring;
  out.most_images = options.most_images;
  out.tap = options.tap;
  return out;
}

// The defaults of the keys that have another value.
std::map<std::string, std::string> DefaultsThatDiffer(const RunFacts& facts) {
  std::map<std::string, std::string> differing;
  for (const auto& [key, text] : facts.default_keys) {
    const auto used = facts.keys.find(key);
    if (used != facts.keys.end() && used->second != text) {
      differing.emplace(key, text);
    }
  }
  return differing;
}

}  // namespace

log::RunSetup SetupOf(const RunFacts& facts, std::int64_t start_ns) {
  log::RunSetup setup;
  setup.name = facts.name;
  setup.joint_names = facts.joint_names;
  setup.arm = facts.servo.arm;
  setup.feature = facts.servo.feature;
  setup.intrinsics = facts.intrinsics;
  setup.lambda = facts.servo.law.lambda;
  setup.target_radius = facts.target_radius;
  setup.target_moves = facts.target_moves;
  setup.workspace_radius = facts.servo.guard.workspace_radius;
  setup.duration_s = facts.duration_s;
  setup.start_ns = start_ns;
  return setup;
}

std::vector<std::string> RunBook::AllFiles(const std::vector<std::string>& more) {
  std::vector<std::string> names{kFilm, kLog, kReport, kSummary};
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

RunBook::RunBook(const std::filesystem::path& out, RunFacts facts, RunBookOptions options)
    : facts_(std::move(facts)),
      options_(std::move(options)),
      all_files_(AllFiles(options_.more_files)),
      page_(config::ShareFolder() / "report"),
      folder_(out),
      log_path_(folder_.Begin(kLog)),
      log_(LogConfig(facts_, options_, log_path_)) {
  if (facts_.has_camera) {
    const film::Overlay::Curve goal = film::GoalCurve(facts_.intrinsics, facts_.servo.feature);
    log::AddOutline(facts_.intrinsics, goal, log::kGoalRole, goal_);
    if (options_.film) {
      film::EyeFilmConfig film;
      film.path = folder_.Begin(kFilm);
      film.intrinsics = facts_.intrinsics;
      film.goal = goal;
      film.p_CO_C_star = facts_.servo.feature.p_CO_C_star;
      film.may_drop = options_.may_drop;
      film_.emplace(film);
    }
  }
  if (options_.begin_ns) {
    Begin(*options_.begin_ns);
  }
}

void RunBook::Begin(std::int64_t start_ns) {
  start_ns_ = start_ns;
  log_.AddMetadata("configuration", facts_.keys);
  log_.AddMetadata("defaults", DefaultsThatDiffer(facts_));
  if (!facts_.command.empty()) {
    log_.AddMetadata("run", {{"command", facts_.command}});
  }
  log_.AddMetadata("build", BuildEntries());
  log_.AddMetadata("robot", {{"name", facts_.robot}, {"model", log::HashOfModel(facts_.servo.arm)}});
  log_.Add(log::kSetupTopic, start_ns, log::SetupMessage(SetupOf(facts_, start_ns)));
  if (options_.replayable) {
    log_.Add(log::kConfigurationTopic, start_ns, flight::ToMessage(facts_.servo));
  }
  if (facts_.has_camera) {
    log_.Add(log::kCalibrationTopic, start_ns, log::CalibrationMessage(start_ns, facts_.intrinsics));
  }
  log_.Add(log::kSceneTopic, start_ns, facts_.scene);
  begun_ = true;
}

void RunBook::AddRecord(const flight::FlightRecord& record) {
  if (!begun_) {
    Begin(record.record.stamp_ns);
  }
  has_ticks_ = true;
  last_ns_ = record.record.stamp_ns;
  log_.AddTick(record.record, flight::ReplayDataOf(record));
}

void RunBook::AddKeyframe(const flight::Keyframe& keyframe) {
  log_.Add(log::kKeyframeTopic, keyframe.state.now_ns, flight::ToMessage(keyframe));
}

void RunBook::AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                       const foxglove::ImageAnnotations& more) {
  if (!begun_ || frame.stamp_ns < start_ns_) {
    return;
  }
  if (film_) {
    film_->Add(frame, detection, start_ns_);
  }
  if (IsPictureDue(frame.stamp_ns)) {
    KeepPicture(frame, detection, more);
  }
}

bool RunBook::IsPictureDue(std::int64_t stamp_ns) {
  if (!std::isfinite(options_.picture_rate_hz) || options_.picture_rate_hz <= 0.0) {
    return options_.picture_rate_hz > 0.0;
  }
  // Due on a grid, also a little early: the stamps of a camera with exactly that rate have jitter.
  const auto period_ns = static_cast<std::int64_t>(1e9 / options_.picture_rate_hz);
  if (stamp_ns < next_picture_ns_ - period_ns / 10) {
    return false;
  }
  // The first picture begins the grid, and so does the first one after a gap.
  const bool on_grid = stamp_ns < next_picture_ns_ + period_ns;
  next_picture_ns_ = (on_grid ? next_picture_ns_ : stamp_ns) + period_ns;
  return true;
}

void RunBook::KeepPicture(const hal::Frame& frame, const vision::Detection& detection,
                          const foxglove::ImageAnnotations& more) {
  foxglove::ImageAnnotations annotations = goal_;
  annotations.MergeFrom(more);
  log::AddDetection(facts_.intrinsics, detection, annotations);
  log_.Add(log::kAnnotationTopic, frame.stamp_ns, annotations);
  log_.AddImage(frame);
  ++pictures_;
}

BookFigures RunBook::EndFilm() {
  BookFigures out;
  if (film_ && film_->frames() > 0) {
    has_film_ = film::CompleteFilm(
        kFilm,
        [this] {
          film_->Finish();
          log_.AddFile(kFilm, "video/mp4", film_->path());
        },
        out.film_errors);
  }
  out.film_frames_dropped = film_ ? film_->dropped() : 0;
  out.pictures_dropped = log_.dropped_images();
  out.pictures = pictures_ - out.pictures_dropped;
  out.ticks_dropped = log_.dropped() - out.pictures_dropped;
  return out;
}

void RunBook::Write(const std::string& summary_json, const linux_rt::DurationHistogram& ticks,
                    const MoreFiles& more) {
  try {
    WriteAll(summary_json, ticks, more);
  } catch (const std::exception& error) {
    // The disk may be full: the data recorded until then must be kept.
    throw std::runtime_error(fmt::format("{}; the {}log is kept in {}", error.what(),
                                         log_.failed() ? "incomplete " : "",
                                         folder_.Keep(kLog, all_files_).string()));
  }
}

void RunBook::KeepLog() const { static_cast<void>(folder_.Keep(kLog, all_files_)); }

void RunBook::WriteAll(const std::string& summary_json, const linux_rt::DurationHistogram& ticks,
                       const MoreFiles& more) {
  if (has_ticks_) {
    log_.Add(log::kTickTimesTopic, last_ns_, log::TickTimesMessage(ticks));
  } else if (!begun_) {  // ended before the first tick: no report, but the log contains the run's setup
    Begin(0);
  }
  log_.AddAttachment(kSummary, "application/json", summary_json);
  std::vector<config::OutputFile> files{{kLog, std::nullopt}};
  if (has_film_) {
    files.push_back({kFilm, std::nullopt});
  }
  log_.Finish();
  if (has_ticks_) {
    report::RunData run = report::ReadRun(log_path_);
    run.source = kLog;  // its final name
    files.push_back({kReport, page_.Make({run})});
  }
  if (more) {
    const std::vector<config::OutputFile> others = more();
    files.insert(files.end(), others.begin(), others.end());
  }
  files.push_back({kSummary, summary_json});  // last: where it exists, the other files exist too
  folder_.Replace(files, all_files_);
}

}  // namespace fovea::run
