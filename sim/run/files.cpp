#include "sim/run/files.hpp"

#include <fmt/format.h>

#include <future>
#include <stdexcept>

#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/film/complete_film.hpp"
#include "firmware/host/film/target_curve.hpp"

namespace fovea::sim {
namespace {

const std::string kLogName = "log.mcap";

// All that any run leaves, for the next to take away.
const std::vector<std::string> kFileNames{"eye-first.png", "eye-last.png", "bench.png",   "camera.mp4",
                                          "scene.mp4",     kLogName,       "report.html", "summary.json"};

}  // namespace

RunFiles::RunFiles(const RunDescription& about, const RunFilesConfig& config) : about_(about) {
  if (config.out.empty()) {
    return;
  }
  if (config.report) {
    page_.emplace(config::ShareFolder() / "report");
  }
  folder_.emplace(config.out);
  if (!config.report) {
    return;
  }
  film::EyeFilmConfig film;
  film.path = folder_->Begin("camera.mp4");
  film.intrinsics = about.intrinsics;
  film.goal = film::GoalCurve(about.intrinsics, about.servo.feature);
  film.p_CO_C_star = about.servo.feature.p_CO_C_star;
  film.may_drop = config.may_drop;
  eye_film_ = std::make_unique<film::EyeFilm>(film);
  if (about.scenario.run.scene_video) {
    scene_film_ = std::make_unique<SceneFilm>(
        SceneFilmConfig{folder_->Begin("scene.mp4"), about.scene, config.renderer_index, config.may_drop});
  }
  log_ = std::make_unique<LogFeed>(about, folder_->Begin(kLogName), config.may_drop, config.replayable);
}

void RunFiles::AddTruth(const Truth& truth) {
  camera_path_.Add(truth.stamp_ns, truth.X_BC.translation());
  target_path_.Add(truth.stamp_ns, truth.p_BO);
  if (log_) {
    log_->AddTruth(truth);
  }
}

void RunFiles::AddTheory(const TheorySample& sample) {
  if (log_) {
    log_->AddTheory(sample);
  }
}

void RunFiles::AddExposure(const Exposure& exposure) {
  if (scene_film_) {
    scene_film_->Add(exposure);
  }
}

void RunFiles::AddRecord(const flight::FlightRecord& record) {
  if (log_) {
    log_->AddRecord(record);
  }
}

void RunFiles::AddKeyframe(const flight::Keyframe& keyframe) {
  if (log_) {
    log_->AddKeyframe(keyframe);
  }
}

void RunFiles::AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                        const model::Pose& X_CO) {
  frames_.Keep(frame, detection, X_CO);
  if (HasReport()) {
    eye_film_->Add(frame, detection);
    log_->AddFrame(frame, detection, X_CO);
  }
}

std::uint64_t RunFiles::film_frames_dropped() const {
  return (eye_film_ ? eye_film_->dropped() : 0) + (scene_film_ ? scene_film_->dropped() : 0);
}

std::vector<std::string> RunFiles::EndFilms() {
  std::vector<std::string> errors;
  if (eye_film_ && eye_film_->frames() > 0) {
    has_eye_film_ = film::CompleteFilm(
        "camera.mp4",
        [this] {
          eye_film_->Finish();
          log_->AddFilm(eye_film_->path());
        },
        errors);
  }
  if (scene_film_ && (frames() > 0 || !about_.scenario.camera.enabled)) {
    has_scene_film_ = film::CompleteFilm(
        "scene.mp4", [this] { scene_film_->Finish(); }, errors);
  }
  return errors;
}

void RunFiles::Write(const Summary& summary, const Exposure& end, const linux_rt::DurationHistogram& ticks) {
  if (!folder_) {
    return;
  }
  try {
    WriteAll(summary, end, ticks);
  } catch (const std::exception& error) {
    if (!log_ || !log_->failed()) {
      throw;
    }
    // A disk that is full: what was recorded before is the more worth keeping.
    throw std::runtime_error(fmt::format("{}; the log is kept as far as it goes, in {}", error.what(),
                                         folder_->Keep(kLogName, kFileNames).string()));
  }
}

void RunFiles::KeepLog() const {
  if (folder_ && log_) {
    static_cast<void>(folder_->Keep(kLogName, kFileNames));
  }
}

void RunFiles::WriteAll(const Summary& summary, const Exposure& end,
                        const linux_rt::DurationHistogram& ticks) {
  const std::string summary_json = ToJson(summary);
  std::vector<config::OutputFile> files;
  // The bench takes longest to draw; the rest is written meanwhile.
  std::future<std::string> bench;
  if (HasReport()) {
    bench = std::async(std::launch::async, [&] {
      return DrawBenchPicture(about_.scene, end, camera_path_.points(), target_path_.points());
    });
  }
  if (frames() > 0) {
    for (const auto& [name, frame] :
         {std::pair{"eye-first.png", &frames_.first()}, std::pair{"eye-last.png", &frames_.last()}}) {
      files.push_back({name, DrawEyePicture(*frame, about_.intrinsics, about_.servo.feature)});
    }
  }
  if (HasReport()) {
    if (has_eye_film_) {
      files.push_back({"camera.mp4", std::nullopt});
    }
    if (has_scene_film_) {
      files.push_back({"scene.mp4", std::nullopt});
    }
    log_->Finish(ticks, summary_json);
    files.push_back({kLogName, std::nullopt});
    report::RunData run = report::ReadRun(log_->path());
    run.source = kLogName;  // as it will be called
    files.push_back({"report.html", page_->Make({run})});
    files.push_back({"bench.png", bench.get()});
  }
  files.push_back({"summary.json", summary_json});
  folder_->Replace(files, kFileNames);
}

}  // namespace fovea::sim
