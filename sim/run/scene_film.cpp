// SPDX-License-Identifier: Apache-2.0
#include "sim/run/scene_film.hpp"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>
#include <utility>

#include "firmware/host/film/overlay.hpp"

namespace fovea::sim {
namespace {

constexpr int kLegendPx = 28;  // height of the strip below the picture
constexpr int kWidth = SceneFilmConfig::kWidthPx;
constexpr int kPictureHeight = SceneFilmConfig::kHeightPx - kLegendPx;
constexpr int kPathPx = 2;
// Hardly better than the camera's quality, because frames are drawn during the run.
constexpr RenderQuality kQuality{/*samples=*/0, /*shadow_map_px=*/512, /*shadow_taps=*/1,
                                 /*shadow_spread=*/1.6F};

RenderScene Bright(RenderScene scene) {
  scene.light = 1.0;
  return scene;
}

}  // namespace

SceneFilm::SceneFilm(const SceneFilmConfig& config)
    : file_(config.path, kWidth, SceneFilmConfig::kHeightPx),
      renderer_(Bright(config.scene), MakeBenchPinhole(kWidth, kPictureHeight), kQuality,
                config.renderer_index),
      rgba_(kPictureHeight, kWidth, CV_8UC4),
      page_(SceneFilmConfig::kHeightPx, kWidth, CV_8UC3),
      queue_(config.may_drop, [this](Exposure& exposure) { Draw(exposure); }) {}

void SceneFilm::Add(const Exposure& exposure) {
  if (std::optional<Exposure> place = queue_.Take()) {
    *place = exposure;
    queue_.Put(std::move(*place));
  }
}

void SceneFilm::Draw(const Exposure& exposure) {
  if (!view_) {
    view_ = MakeBenchView(exposure, renderer_.pinhole());
  }
  renderer_.Draw(exposure, view_->X_BV, {rgba_.data, rgba_.total() * rgba_.elemSize()});
  renderer_.Release();  // another thread destroys it
  cv::Mat picture = page_.rowRange(0, kPictureHeight);
  cv::cvtColor(rgba_, picture, cv::COLOR_RGBA2BGR);

  camera_path_.Add(exposure.stamp_ns, exposure.X_BC.translation());
  target_path_.Add(exposure.stamp_ns, exposure.p_BO);
  DrawPath(picture, *view_, target_path_.points(), film::kGoalColour, kPathPx);
  DrawPath(picture, *view_, camera_path_.points(), film::kDetectionColour, kPathPx);

  page_.rowRange(kPictureHeight, page_.rows).setTo(film::kLegendColour);
  const int y = kPictureHeight + 19;
  const auto write = [&](const std::string& text, int x, const cv::Scalar& colour) {
    film::DrawText(page_, text, x, y, 0.45, colour);
  };
  write(fmt::format("t = {:.3f} s", static_cast<double>(exposure.stamp_ns) * 1e-9), 10, film::kTruthColour);
  write("the camera's path", kWidth / 3, film::kDetectionColour);
  write("the target's path", 2 * kWidth / 3, film::kGoalColour);
  file_.Add(page_, exposure.stamp_ns);
}

void SceneFilm::Finish() {
  queue_.Finish();
  file_.Finish();
}

}  // namespace fovea::sim
