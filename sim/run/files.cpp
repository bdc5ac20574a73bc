// SPDX-License-Identifier: Apache-2.0
#include "sim/run/files.hpp"

#include "firmware/host/film/complete_film.hpp"
#include "sim/run/truth_log.hpp"

namespace fovea::sim {
namespace {

const std::string kSceneFilm = "scene.mp4";

// Files of a simulated run, in addition to those of any run.
const std::vector<std::string> kMoreFiles{"eye-first.png", "eye-last.png", "frame-last.png", "bench.png",
                                          kSceneFilm};

}  // namespace

run::RunFolderConfig FolderOf(const RunDescription& about, const RunFilesConfig& config) {
  run::RunFolderConfig folder;
  folder.out = config.out;
  if (config.report && !config.out.empty()) {
    folder.facts = FactsOf(about);
    folder.facts->command = config.command;
    folder.facts->duration_s = config.open_ended ? 0.0 : folder.facts->duration_s;
  }
  folder.options.more_files = kMoreFiles;
  folder.options.may_drop = config.may_drop;
  folder.options.replayable = config.replayable;
  folder.options.tap = config.tap;
  folder.options.begin_ns = 0;  // in the world's time
  return folder;
}

RunFiles::RunFiles(const RunDescription& about, const RunFilesConfig& config, run::RunShell& shell)
    : about_(about), shell_(shell), pictures_if_failed_(config.pictures_if_failed) {
  if (shell_.book() != nullptr && about.scenario.run.scene_video) {
    scene_film_ = std::make_unique<SceneFilm>(SceneFilmConfig{
        shell_.book()->BeginFile(kSceneFilm), about.scene, config.renderer_index, config.may_drop});
  }
}

void RunFiles::AddTruth(const Truth& truth) {
  camera_path_.Add(truth.stamp_ns, truth.X_BC.translation());
  target_path_.Add(truth.stamp_ns, truth.p_BO);
  if (run::RunBook* book = shell_.book()) {
    LogTruth(about_, truth, book->log());
  }
}

void RunFiles::AddTheory(const TheorySample& sample) {
  if (run::RunBook* book = shell_.book()) {
    LogTheory(sample, book->log());
  }
}

void RunFiles::AddExposure(const Exposure& exposure) {
  if (scene_film_) {
    scene_film_->Add(exposure);
  }
}

void RunFiles::AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                        const model::Pose& X_CO) {
  frames_.Keep(frame, detection, X_CO);
  if (shell_.book() != nullptr) {
    shell_.AddFrame(frame, detection, TruthOnPicture(about_, X_CO));
  }
}

void RunFiles::Fill(Summary& summary) {
  summary.frames = frames_.frames();
  summary.frames_detected = frames_.detected();
  if (scene_film_ && (summary.frames > 0 || !about_.scenario.camera.enabled)) {
    has_scene_film_ = film::CompleteFilm(
        kSceneFilm, [this] { scene_film_->Finish(); }, summary.film_errors);
  }
  summary.film_frames_dropped += scene_film_ ? scene_film_->dropped() : 0;
}

void RunFiles::Write(const Summary& summary, const Exposure& end) {
  // The bench's picture takes longest; the other files are written in the meantime.
  std::future<std::string> bench;
  if (shell_.book() != nullptr) {
    bench = std::async(std::launch::async, [&] {
      return DrawBenchPicture(about_.scene, end, camera_path_.points(), target_path_.points());
    });
  }
  const bool with_pictures = !pictures_if_failed_ || !ReachedItsGoal(summary);
  shell_.Write(ToJson(summary), [&] { return PicturesAndScene(std::move(bench), with_pictures); });
}

std::vector<config::OutputFile> RunFiles::PicturesAndScene(std::future<std::string> bench,
                                                           bool with_pictures) {
  std::vector<config::OutputFile> files;
  if (with_pictures && frames_.frames() > 0) {
    for (const auto& [name, frame] :
         {std::pair{"eye-first.png", &frames_.first()}, std::pair{"eye-last.png", &frames_.last()}}) {
      files.push_back({name, DrawEyePicture(*frame, about_.intrinsics, about_.servo.feature)});
    }
    files.push_back({"frame-last.png", DrawFrame(frames_.last())});
  }
  if (has_scene_film_) {
    files.push_back({kSceneFilm, std::nullopt});
  }
  if (bench.valid()) {
    files.push_back({"bench.png", bench.get()});
  }
  return files;
}

}  // namespace fovea::sim
