// SPDX-License-Identifier: Apache-2.0
// Film of the camera's frames, with detection, goal and time drawn in; encoded while the run goes on.
#pragma once

#include <cstdint>
#include <filesystem>

#include "firmware/host/film/film_queue.hpp"
#include "firmware/host/film/overlay.hpp"
#include "firmware/host/film/video_file.hpp"
#include "firmware/vision/detection.hpp"
#include "fovea/hal/camera.hpp"

namespace fovea::film {

struct EyeFilmConfig {
  std::filesystem::path path;
  vision::Intrinsics intrinsics;
  Overlay::Curve goal;                                    // the target's outline at its goal
  Eigen::Vector3d p_CO_C_star = Eigen::Vector3d::Zero();  // the goal [m]
  bool may_drop = false;  // when encoding is slower than the camera: drop a frame (true) or wait (false)
};

class EyeFilm {
 public:
  explicit EyeFilm(const EyeFilmConfig& config);
  // From the vision thread; copies the pixels. The film's time counts from `begin_ns`, on the clock of the
  // frames' stamps. Skips a frame whose size differs from the intrinsics.
  void Add(const hal::Frame& frame, const vision::Detection& detection, std::int64_t begin_ns = 0);
  // Encodes the remaining frames and completes the file. Throws any error since the start.
  void Finish();
  // Frames dropped for lack of room; frames added (read it after the last Add): without one there is no film.
  [[nodiscard]] std::uint64_t dropped() const { return queue_.dropped(); }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] const std::filesystem::path& path() const { return config_.path; }

 private:
  struct Item {
    cv::Mat page;  // the picture, with room for the legend below
    std::int64_t time_ns = 0;
    vision::Detection detection;
  };
  void Draw(Item& item) const;

  const EyeFilmConfig config_;
  cv::Mat legend_;  // the part that is the same in every frame
  std::uint64_t frames_ = 0;
  VideoFile file_;
  FilmQueue<Item> queue_;  // last: its thread uses the others
};

}  // namespace fovea::film
