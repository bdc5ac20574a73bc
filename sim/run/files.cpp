#include "sim/run/files.hpp"

#include "firmware/host/film/complete_film.hpp"
#include "sim/run/truth_log.hpp"

namespace fovea::sim {
namespace {

const std::string kSceneFilm = "scene.mp4";
const std::string kSummary = "summary.json";

// What a simulated run leaves beside the book's own files.
const std::vector<std::string> kMoreFiles{"eye-first.png", "eye-last.png", "bench.png", kSceneFilm};

run::RunBookOptions BookOptions(const RunFilesConfig& config) {
  run::RunBookOptions options;
  options.more_files = kMoreFiles;
  options.may_drop = config.may_drop;
  options.replayable = config.replayable;
  options.begin_ns = 0;  // of the world's clock
  return options;
}

}  // namespace

RunFiles::RunFiles(const RunDescription& about, const RunFilesConfig& config) : about_(about) {
  if (config.out.empty()) {
    return;
  }
  if (!config.report) {
    folder_.emplace(config.out);
    return;
  }
  book_.emplace(config.out, FactsOf(about), BookOptions(config));
  if (about.scenario.run.scene_video) {
    scene_film_ = std::make_unique<SceneFilm>(
        SceneFilmConfig{book_->BeginFile(kSceneFilm), about.scene, config.renderer_index, config.may_drop});
  }
}

void RunFiles::AddTruth(const Truth& truth) {
  camera_path_.Add(truth.stamp_ns, truth.X_BC.translation());
  target_path_.Add(truth.stamp_ns, truth.p_BO);
  if (book_) {
    LogTruth(about_, truth, book_->log());
  }
}

void RunFiles::AddTheory(const TheorySample& sample) {
  if (book_) {
    LogTheory(sample, book_->log());
  }
}

void RunFiles::AddExposure(const Exposure& exposure) {
  if (scene_film_) {
    scene_film_->Add(exposure);
  }
}

void RunFiles::AddRecord(const flight::FlightRecord& record) {
  if (book_) {
    book_->AddRecord(record);
  }
}

void RunFiles::AddKeyframe(const flight::Keyframe& keyframe) {
  if (book_) {
    book_->AddKeyframe(keyframe);
  }
}

void RunFiles::AddFrame(const hal::Frame& frame, const vision::Detection& detection,
                        const model::Pose& X_CO) {
  frames_.Keep(frame, detection, X_CO);
  if (book_) {
    book_->AddFrame(frame, detection, TruthOnPicture(about_, X_CO));
  }
}

run::BookFigures RunFiles::EndFilms() {
  run::BookFigures figures;
  if (!book_) {
    return figures;
  }
  figures = book_->EndFilm();
  if (scene_film_ && (frames() > 0 || !about_.scenario.camera.enabled)) {
    has_scene_film_ = film::CompleteFilm(
        kSceneFilm, [this] { scene_film_->Finish(); }, figures.film_errors);
  }
  figures.film_frames_dropped += scene_film_ ? scene_film_->dropped() : 0;
  return figures;
}

void RunFiles::Write(const Summary& summary, const Exposure& end, const linux_rt::DurationHistogram& ticks) {
  const std::string summary_json = ToJson(summary);
  if (folder_) {
    std::vector<config::OutputFile> files = PicturesAndScene({});
    files.push_back({kSummary, summary_json});
    folder_->Replace(files, run::RunBook::AllFiles(kMoreFiles));
  }
  if (book_) {
    // The bench takes longest to draw; the rest is written meanwhile.
    std::future<std::string> bench = std::async(std::launch::async, [&] {
      return DrawBenchPicture(about_.scene, end, camera_path_.points(), target_path_.points());
    });
    book_->Write(summary_json, ticks, [&] { return PicturesAndScene(std::move(bench)); });
  }
}

std::vector<config::OutputFile> RunFiles::PicturesAndScene(std::future<std::string> bench) {
  std::vector<config::OutputFile> files;
  if (frames() > 0) {
    for (const auto& [name, frame] :
         {std::pair{"eye-first.png", &frames_.first()}, std::pair{"eye-last.png", &frames_.last()}}) {
      files.push_back({name, DrawEyePicture(*frame, about_.intrinsics, about_.servo.feature)});
    }
  }
  if (has_scene_film_) {
    files.push_back({kSceneFilm, std::nullopt});
  }
  if (bench.valid()) {
    files.push_back({"bench.png", bench.get()});
  }
  return files;
}

void RunFiles::KeepLog() const {
  if (book_) {
    book_->KeepLog();
  }
}

}  // namespace fovea::sim
