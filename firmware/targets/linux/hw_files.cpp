#include "firmware/targets/linux/hw_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "firmware/host/build_info.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/film/complete_film.hpp"
#include "firmware/host/film/target_curve.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/log/picture_messages.hpp"
#include "firmware/host/recording/log/record_hash.hpp"
#include "firmware/host/recording/log/run_messages.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/targets/linux/hw_scene.hpp"
#include "firmware/vision/fit/outline.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "foxglove/scene.pb.h"

namespace fovea::hw {
namespace {

constexpr std::size_t kRing = 8192;  // ticks that may wait for the disk: eight seconds
constexpr std::size_t kMostImages = 32;

const std::string kFilmName = "camera.mp4";

// All that any run leaves, for the next to take away.
const std::vector<std::string> kFileNames{kFilmName, "log.mcap", "report.html", "summary.json"};

log::RunLogConfig MakeRunLogConfig(const HwConfig& config, const robots::Robot& robot,
                                   const std::filesystem::path& path) {
  log::RunLogConfig out;
  out.path = path;
  out.library = fmt::format("fovea {}", kVersion);
  out.arm = robot.model;
  out.frames = MakeLinkFrames(robot, config.HasCamera(), config::MakeMount(config.camera.calibration));
  out.may_drop = true;
  out.ring = kRing;
  out.most_images = kMostImages;
  return out;
}

// Of the ball about its centre that holds the target.
double Reach(const features::TargetFeature& target) {
  const features::TargetOutline outline = target.Outline();
  double reach = 0.0;
  for (int i = 0; i < outline.num_points; ++i) {
    reach = std::max(reach, outline.p_OP[static_cast<std::size_t>(i)].norm() + outline.radius);
  }
  return reach;
}

}  // namespace

HwFiles::HwFiles(const std::string& out, const HwConfig& config, const robots::Robot& robot,
                 const config::ServoConfig& servo, double duration_s)
    : config_(config),
      robot_(robot),
      servo_(servo),
      duration_s_(duration_s),
      page_(config::ShareFolder() / "report"),
      folder_(out),
      log_path_(folder_.Begin("log.mcap")),
      log_(MakeRunLogConfig(config, robot, log_path_)) {
  if (config.HasCamera()) {
    const vision::Intrinsics intrinsics = config::MakeIntrinsics(config.camera.calibration);
    const features::TargetFeature& goal = servo.feature;
    log::AddOutline(intrinsics,
                    vision::TargetOutline(config::MakeVisionConfig(config.vision, intrinsics, config.target),
                                          {goal.R_CO_star, goal.p_CO_C_star}),
                    log::kGoalRole, goal_);
    if (config.log.film) {
      film::EyeFilmConfig film;
      film.path = folder_.Begin(kFilmName);
      film.intrinsics = intrinsics;
      film.goal = film::GoalCurve(intrinsics, goal);
      film.p_CO_C_star = goal.p_CO_C_star;
      film.may_drop = true;
      film_.emplace(film);
    }
  }
}

void HwFiles::Begin(std::int64_t start_ns) {
  start_ns_ = start_ns;
  HwConfig values = config_;
  log_.AddMetadata("configuration", HwKeys(values).Values());
  log_.AddMetadata("build", BuildEntries());
  log_.AddMetadata("robot", {{"name", robot_.name}, {"model", log::HashOfModel(servo_.arm)}});
  log::RunSetup setup;
  setup.name = config_.name;
  setup.joint_names = robot_.joint_names;
  setup.arm = servo_.arm;
  setup.feature = servo_.feature;
  setup.lambda = servo_.law.lambda;
  setup.workspace_radius = servo_.guard.workspace_radius;
  setup.duration_s = duration_s_;
  setup.start_ns = start_ns;
  if (config_.HasCamera()) {
    setup.intrinsics = config::MakeIntrinsics(config_.camera.calibration);
    setup.target_radius = Reach(servo_.feature);
    log_.Add(log::kCalibrationTopic, start_ns, log::CalibrationMessage(start_ns, setup.intrinsics));
  }
  log_.Add(log::kSetupTopic, start_ns, log::SetupMessage(setup));
  log_.Add(log::kConfigurationTopic, start_ns, flight::ToMessage(servo_));
  log_.Add(log::kSceneTopic, start_ns, MakeSceneMessage(robot_, config_.HasCamera(), servo_.feature));
  begun_ = true;
}

void HwFiles::AddRecord(const flight::FlightRecord& record) {
  if (!begun_) {
    Begin(record.record.stamp_ns);
  }
  last_ns_ = record.record.stamp_ns;
  log_.AddTick(record.record, flight::ReplayDataOf(record));
}

void HwFiles::AddKeyframe(const flight::Keyframe& keyframe) {
  log_.Add(log::kKeyframeTopic, keyframe.state.now_ns, flight::ToMessage(keyframe));
}

void HwFiles::AddFrame(const hal::Frame& frame, const vision::Detection& detection) {
  if (!begun_ || frame.stamp_ns < start_ns_) {
    return;
  }
  if (film_) {
    film_->Add(frame, detection, start_ns_);
  }
  if (config_.log.picture_rate_hz > 0.0) {
    KeepPicture(frame, detection);
  }
}

// Into the log, as often as it is wished for.
void HwFiles::KeepPicture(const hal::Frame& frame, const vision::Detection& detection) {
  // On a grid, and a little before its time too: stamps of a camera of just that rate have jitter.
  const auto period_ns = static_cast<std::int64_t>(1e9 / config_.log.picture_rate_hz);
  if (frame.stamp_ns < next_picture_ns_ - period_ns / 10) {
    return;
  }
  // The first picture begins the grid, and so does the first one after a gap.
  const bool on_grid = frame.stamp_ns < next_picture_ns_ + period_ns;
  next_picture_ns_ = (on_grid ? next_picture_ns_ : frame.stamp_ns) + period_ns;
  foxglove::ImageAnnotations annotations = goal_;
  log::AddDetection(config::MakeIntrinsics(config_.camera.calibration), detection, annotations);
  log_.Add(log::kAnnotationTopic, frame.stamp_ns, annotations);
  log_.AddImage(frame);
  ++pictures_;
}

LogCounters HwFiles::EndFilm() {
  LogCounters out;
  if (film_ && film_->frames() > 0) {
    has_film_ = film::CompleteFilm(
        kFilmName,
        [this] {
          film_->Finish();
          log_.AddFile(kFilmName, "video/mp4", film_->path());
        },
        out.film_errors);
  }
  out.film_frames_dropped = film_ ? film_->dropped() : 0;
  out.pictures_dropped = log_.dropped_images();
  out.pictures = pictures_ - out.pictures_dropped;
  out.ticks_dropped = log_.dropped() - out.pictures_dropped;
  return out;
}

void HwFiles::Write(const HwSummary& summary) {
  try {
    WriteAll(summary);
  } catch (const std::exception& error) {
    if (!log_.failed()) {
      throw;
    }
    // A disk that is full: what was recorded before is the more worth keeping.
    throw std::runtime_error(fmt::format("{}; the log is kept as far as it goes, in {}", error.what(),
                                         folder_.Keep("log.mcap", kFileNames).string()));
  }
}

void HwFiles::WriteAll(const HwSummary& summary) {
  const std::string summary_json = ToJson(summary);
  const bool has_ticks = begun_;
  if (has_ticks) {
    log_.Add(log::kTickTimesTopic, last_ns_, log::TickTimesMessage(summary.ticks));
  } else {  // ended before it moved; there is nothing to draw, and the log says what it was to be
    Begin(0);
  }
  log_.AddAttachment("summary.json", "application/json", summary_json);
  std::vector<config::OutputFile> files{{"log.mcap", std::nullopt}, {"summary.json", summary_json}};
  if (has_film_) {
    files.push_back({kFilmName, std::nullopt});
  }
  log_.Finish();
  if (has_ticks) {
    report::RunData run = report::ReadRun(log_path_);
    run.source = "log.mcap";  // as it will be called
    files.push_back({"report.html", page_.Make({run})});
  }
  folder_.Replace(files, kFileNames);
}

}  // namespace fovea::hw
