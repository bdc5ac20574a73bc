// The run as someone beside the bench sees it, as a film: each exposure of the eye drawn a second time, with
// the paths of camera and target so far and the time. Drawn and encoded beside the run.
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
  RenderScene scene;       // shown in full light, however dark the eye's picture is
  int renderer_index = 0;  // see SceneRenderer
  bool may_drop = false;   // when drawing is slower than the camera: drop a frame (true) or wait (false)
};

class SceneFilm {
 public:
  // std::runtime_error with one line when there is no EGL, or no such file.
  explicit SceneFilm(const SceneFilmConfig& config);

  // From the thread that advances the world; copies a few poses.
  void Add(const Exposure& exposure);
  // Draws and encodes what is left and completes the file. Throws what went wrong at any time.
  void Finish();
  // Frames that found no place.
  [[nodiscard]] std::uint64_t dropped() const { return queue_.dropped(); }

 private:
  void Draw(const Exposure& exposure);

  // Used by the queue's thread alone.
  film::VideoFile file_;
  SceneRenderer renderer_;
  std::optional<BenchView> view_;  // from the first frame on
  Path camera_path_;
  Path target_path_;
  cv::Mat rgba_;
  cv::Mat page_;

  film::FilmQueue<Exposure> queue_;  // last: its thread uses the others
};

}  // namespace fovea::sim
