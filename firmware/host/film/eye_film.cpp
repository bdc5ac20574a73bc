// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/film/eye_film.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "firmware/host/film/overlay.hpp"

namespace fovea::film {
namespace {

constexpr int kLegendPx = 28;    // height of the strip below the picture
constexpr int kBaselinePx = 19;  // of the text in it

// H.264 with halved colour planes needs even sizes.
int Even(int size) { return size + size % 2; }

cv::Size PageSize(const vision::Intrinsics& in) {
  return {Even(in.width_px), Even(in.height_px + kLegendPx)};
}

}  // namespace

EyeFilm::EyeFilm(const EyeFilmConfig& config)
    : config_(config),
      legend_(PageSize(config.intrinsics).height - config.intrinsics.height_px,
              PageSize(config.intrinsics).width, CV_8UC3, kLegendColour),
      file_(config.path, PageSize(config.intrinsics).width, PageSize(config.intrinsics).height),
      queue_(config.may_drop, [this](Item& item) {
        Draw(item);
        file_.Add(item.page, item.time_ns);
      }) {
  DrawText(legend_, "dashed: goal", config.intrinsics.width_px / 3, kBaselinePx, 0.45, kGoalColour);
}

void EyeFilm::Add(const hal::Frame& frame, const vision::Detection& detection, std::int64_t begin_ns) {
  if (frame.width_px != config_.intrinsics.width_px || frame.height_px != config_.intrinsics.height_px) {
    return;
  }
  std::optional<Item> place = queue_.Take();
  if (!place) {
    return;
  }
  Item& item = *place;
  if (item.page.empty()) {
    item.page.create(PageSize(config_.intrinsics), CV_8UC3);
    item.page.setTo(kLegendColour);
  }
  legend_.copyTo(item.page.rowRange(frame.height_px, item.page.rows));
  const bool mono = frame.format == hal::PixelFormat::kMono8;
  const cv::Mat pixels(frame.height_px, frame.width_px, mono ? CV_8UC1 : CV_8UC3,
                       const_cast<std::uint8_t*>(frame.pixels.data()),
                       static_cast<std::size_t>(frame.stride_bytes));
  cv::Mat picture = item.page(cv::Rect(0, 0, frame.width_px, frame.height_px));
  if (mono) {
    cv::cvtColor(pixels, picture, cv::COLOR_GRAY2BGR);
  } else {
    pixels.copyTo(picture);
  }
  item.time_ns = frame.stamp_ns - begin_ns;
  item.detection = detection;
  queue_.Put(std::move(item));
  ++frames_;
}

void EyeFilm::Draw(Item& item) const {
  const vision::Intrinsics& in = config_.intrinsics;
  cv::Mat picture = item.page(cv::Rect(0, 0, in.width_px, in.height_px));
  Overlay overlay(picture, in, 1);
  overlay.Goal(config_.goal, config_.p_CO_C_star);
  overlay.Detection(item.detection);
  const int y = in.height_px + kBaselinePx;
  DrawText(item.page, fmt::format("t = {:.3f} s", static_cast<double>(item.time_ns) * 1e-9), 10, y, 0.45,
           kTruthColour);
  std::string words = "no detection";
  if (item.detection.found) {
    const double error_px = std::hypot(in.U(item.detection.Middle()) - in.U(config_.p_CO_C_star),
                                       in.V(item.detection.Middle()) - in.V(config_.p_CO_C_star));
    words = fmt::format("detection, {:.1f} px off", error_px);
  }
  DrawText(item.page, words, 2 * in.width_px / 3, y, 0.45, kDetectionColour);
}

void EyeFilm::Finish() {
  queue_.Finish();
  file_.Finish();
}

}  // namespace fovea::film
