// What the eye saw, as a film: each frame with detection, goal and time drawn in, encoded beside the run.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>

#include "fovea/hal/camera.hpp"
#include "fovea/vision/ball_detector.hpp"
#include "sim/app/video_file.hpp"

namespace fovea::sim {

struct EyeFilmConfig {
  std::filesystem::path path;
  vision::Intrinsics intrinsics;
  double radius = 0.04;                                   // of the target [m]
  Eigen::Vector3d p_CO_C_star = Eigen::Vector3d::Zero();  // the goal [m]
  bool may_drop = false;  // when encoding is slower than the camera: drop a frame (true) or wait (false)
};

class EyeFilm {
 public:
  explicit EyeFilm(const EyeFilmConfig& config);
  ~EyeFilm();
  EyeFilm(const EyeFilm&) = delete;
  EyeFilm& operator=(const EyeFilm&) = delete;

  // From the vision thread; copies the pixels.
  void Add(const hal::Frame& frame, const vision::BallDetection& detection);
  // Encodes what is left and completes the file. Throws what went wrong at any time.
  void Finish();
  // Frames that found no place.
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  struct Item {
    cv::Mat page;  // the picture, with room for the legend below
    std::int64_t stamp_ns = 0;
    vision::BallDetection detection;
  };
  void Close();
  void Encode();
  void Draw(Item& item) const;

  const EyeFilmConfig config_;
  VideoFile file_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::deque<cv::Mat> spare_;  // pages to use again
  bool closed_ = false;
  std::uint64_t dropped_ = 0;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace fovea::sim
