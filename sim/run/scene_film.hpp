// SPDX-License-Identifier: Apache-2.0
// A film of the run, viewed from beside the bench: each exposure drawn a second time, with the paths of
// camera and target so far, and the time. Another thread draws and encodes it during the run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "firmware/host/film/film_queue.hpp"
#include "firmware/host/film/video_file.hpp"
#include "sim/render/scene_renderer.hpp"
#include "sim/run/bench_view.hpp"
#include "sim/run/path.hpp"

namespace fovea::sim {

struct SceneFilmConfig {
  static constexpr int kWidthPx = 960;
  static constexpr int kHeightPx = 600;  // with the legend below the picture

  std::filesystem::path path;
  RenderScene scene;       // drawn in full light, even if the camera's picture is dark
  int renderer_index = 0;  // see SceneRenderer
  bool may_drop = false;   // when drawing is slower than the camera: drop a frame (true) or wait (false)
};

class SceneFilm {
 public:
  // std::runtime_error with one line: there is no EGL, or the file cannot be written.
  explicit SceneFilm(const SceneFilmConfig& config);

  // Copies a few poses. Called by the thread that advances the world.
  void Add(const Exposure& exposure);
  // Draws and encodes the remaining frames and completes the file. Throws any error that occurred before.
  void Finish();
  // Frames dropped because the queue was full.
  [[nodiscard]] std::uint64_t dropped() const { return queue_.dropped(); }

 private:
  void Draw(const Exposure& exposure);

  // Used only by the queue's thread.
  film::VideoFile file_;
  SceneRenderer renderer_;
  std::optional<BenchView> view_;  // from the first frame on
  Path camera_path_;
  Path target_path_;
  cv::Mat rgba_;
  cv::Mat page_;

  film::FilmQueue<Exposure> queue_;  // declared last: its thread uses the other members
};

}  // namespace fovea::sim
