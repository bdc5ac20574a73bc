// SPDX-License-Identifier: Apache-2.0
// The files that only a simulated run has: the truth in its log, pictures, the film of the bench. RunShell
// writes log, report and summary.
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
  std::filesystem::path out;        // empty: no files
  bool report = true;               // also write films, log, report and the bench's picture
  bool pictures_if_failed = false;  // the camera's pictures only if the run does not reach its goal
  int renderer_index = 0;           // the first index that the run itself does not use; see SceneRenderer
  bool may_drop = false;            // at real pace: the run does not wait for film or log
  bool replayable = true;           // the recorded inputs are those of the servo
  std::string command{};            // command line of the run; "" if none
  log::LogTap tap{};                // gets each message of the log; empty: nobody does
  bool open_ended = false;          // the run lasts until somebody ends it
};

// The folder for the RunShell of these RunFiles.
run::RunFolderConfig FolderOf(const RunDescription& about, const RunFilesConfig& config);

class RunFiles {
 public:
  // `about` and `shell` must outlive it. std::runtime_error: this computer cannot draw the bench.
  RunFiles(const RunDescription& about, const RunFilesConfig& config, run::RunShell& shell);

  // Called by the thread that advances the world.
  void AddTruth(const Truth& truth);
  void AddExposure(const Exposure& exposure);
  void AddTheory(const TheorySample& sample);
  // Called by the vision thread. `X_CO`: the target's true pose.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO);

  // Completes the bench's film and fills in the counts of its frames and the camera's. Call it after the
  // threads have ended. A film that fails is left out; the run continues.
  void Fill(Summary& summary);

  // Writes all files by RunShell::Write. Call it after the shell's Fill. `end`: the bench at the end.
  void Write(const Summary& summary, const Exposure& end);

 private:
  // The pictures of the camera if `with_pictures`, the film of the bench, and its picture if `bench` is
  // valid.
  std::vector<config::OutputFile> PicturesAndScene(std::future<std::string> bench, bool with_pictures);

  const RunDescription& about_;
  run::RunShell& shell_;
  const bool pictures_if_failed_;
  std::unique_ptr<SceneFilm> scene_film_;
  bool has_scene_film_ = false;  // the film is complete
  FrameKeeper frames_;
  Path camera_path_;
  Path target_path_;
};

}  // namespace fovea::sim
