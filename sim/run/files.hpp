// What a run leaves behind: films, log, report, pictures and summary, gathered while it goes on.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/output_folder.hpp"
#include "firmware/host/run/run_book.hpp"
#include "sim/run/path.hpp"
#include "sim/run/pictures.hpp"
#include "sim/run/scene_film.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/verdict/summary.hpp"

namespace fovea::sim {

struct RunFilesConfig {
  std::filesystem::path out;  // empty: no files
  bool report = true;         // films, log, report and the bench's picture too
  int renderer_index = 0;     // the first that the run itself does not use; see SceneRenderer
  bool may_drop = false;      // at real pace: nobody waits for a film or a log
  bool replayable = true;     // the servo's inputs are those that are recorded
};

class RunFiles {
 public:
  // `about` must outlive it. InputError when nothing can be written there; std::runtime_error when the
  // report's page is not there.
  RunFiles(const RunDescription& about, const RunFilesConfig& config);

  // From the thread that advances the world.
  void AddTruth(const Truth& truth);
  void AddExposure(const Exposure& exposure);
  void AddTheory(const TheorySample& sample);
  // From the thread that empties the recorder.
  void AddRecord(const flight::FlightRecord& record);
  void AddKeyframe(const flight::Keyframe& keyframe);
  // From the vision thread. `X_CO`: where the target really was.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO);

  // When the threads are done: completes the films, and says what was kept and what was not. A film that
  // fails is left out, and that is all.
  run::BookFigures EndFilms();

  [[nodiscard]] bool HasLog() const { return book_.has_value(); }
  // When the threads are done: frames that the vision task got, and in how many it found the target.
  [[nodiscard]] std::uint64_t frames() const { return frames_.frames(); }
  [[nodiscard]] std::uint64_t frames_detected() const { return frames_.detected(); }

  // Puts everything in place; `end` is the bench as it is at the end. Throws what went wrong with any of it;
  // then the folder is as it was, but for a log that could not be written on: it stands there alone.
  void Write(const Summary& summary, const Exposure& end, const linux_rt::DurationHistogram& ticks);
  // From any thread, when the process ends before Write is done: the log stands there alone, as far as it
  // goes.
  void KeepLog() const;

 private:
  // The pictures of the eye, the film of the bench, and, where one is asked for, its picture.
  std::vector<config::OutputFile> PicturesAndScene(std::future<std::string> bench);

  const RunDescription& about_;
  std::optional<run::RunBook> book_;            // with films, log and report
  std::optional<config::OutputFolder> folder_;  // without
  std::unique_ptr<SceneFilm> scene_film_;
  bool has_scene_film_ = false;  // and it is complete
  FrameKeeper frames_;
  Path camera_path_;
  Path target_path_;
};

}  // namespace fovea::sim
