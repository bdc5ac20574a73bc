// What only a simulated run leaves behind, gathered while it goes on: the truth in its log, pictures, the
// film of its bench. Log, report and summary are the run's shell's.
#pragma once

#include <future>
#include <memory>
#include <string>
#include <vector>

#include "firmware/host/config/output_folder.hpp"
#include "firmware/host/run/run_shell.hpp"
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
  std::string command;        // that began the run; "" when there was none
};

// Of the shell that RunFiles is then made with.
run::RunFolderConfig FolderOf(const RunDescription& about, const RunFilesConfig& config);

class RunFiles {
 public:
  // `about` and `shell` must outlive it. std::runtime_error: the bench cannot be drawn here.
  RunFiles(const RunDescription& about, const RunFilesConfig& config, run::RunShell& shell);

  // From the thread that advances the world.
  void AddTruth(const Truth& truth);
  void AddExposure(const Exposure& exposure);
  void AddTheory(const TheorySample& sample);
  // From the vision thread. `X_CO`: where the target really was.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO);

  // When the threads are done: completes the bench's film, and says what was kept of it and of the frames. A
  // film that fails is left out, and that is all.
  void Fill(Summary& summary);

  // After the shell's Fill: puts everything in place, as RunShell::Write; `end` is the bench as it is at the
  // end.
  void Write(const Summary& summary, const Exposure& end);

 private:
  // The pictures of the eye, the film of the bench, and, where one is asked for, its picture.
  std::vector<config::OutputFile> PicturesAndScene(std::future<std::string> bench);

  const RunDescription& about_;
  run::RunShell& shell_;
  std::unique_ptr<SceneFilm> scene_film_;
  bool has_scene_film_ = false;  // and it is complete
  FrameKeeper frames_;
  Path camera_path_;
  Path target_path_;
};

}  // namespace fovea::sim
