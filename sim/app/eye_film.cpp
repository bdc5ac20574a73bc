#include "sim/app/eye_film.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "fovea/linux_rt/realtime.hpp"
#include "sim/app/overlay.hpp"

namespace fovea::sim {
namespace {

constexpr std::size_t kQueue = 8;  // frames that may wait
constexpr int kLegendPx = 28;      // height of the strip below the picture

// H.264 with halved colour planes wants even sizes.
int Even(int size) { return size + size % 2; }

cv::Size PageSize(const vision::Intrinsics& in) {
  return {Even(in.width_px), Even(in.height_px + kLegendPx)};
}

}  // namespace

EyeFilm::EyeFilm(const EyeFilmConfig& config)
    : config_(config),
      file_(config.path, PageSize(config.intrinsics).width, PageSize(config.intrinsics).height),
      thread_([this] { Encode(); }) {}

EyeFilm::~EyeFilm() { Close(); }

void EyeFilm::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void EyeFilm::Add(const hal::Frame& frame, const vision::BallDetection& detection) {
  Item item;
  {
    std::unique_lock lock(mutex_);
    const auto has_room = [this] { return items_.size() < kQueue || failure_ != nullptr; };
    if (!config_.may_drop) {
      changed_.wait(lock, has_room);
    }
    if (!has_room() || failure_ != nullptr) {
      ++dropped_;
      return;
    }
    if (!spare_.empty()) {
      item.page = std::move(spare_.back());
      spare_.pop_back();
    }
  }
  if (item.page.empty()) {
    item.page.create(PageSize(config_.intrinsics), CV_8UC3);
    item.page.setTo(kLegendColour);
  }
  item.page.rowRange(frame.height_px, item.page.rows).setTo(kLegendColour);
  const cv::Mat pixels(frame.height_px, frame.width_px, CV_8UC3,
                       const_cast<std::uint8_t*>(frame.pixels.data()),
                       static_cast<std::size_t>(frame.stride_bytes));
  pixels.copyTo(item.page(cv::Rect(0, 0, frame.width_px, frame.height_px)));
  item.stamp_ns = frame.stamp_ns;
  item.detection = detection;
  {
    const std::lock_guard lock(mutex_);
    items_.push_back(std::move(item));
  }
  changed_.notify_all();
}

void EyeFilm::Draw(Item& item) const {
  const vision::Intrinsics& in = config_.intrinsics;
  cv::Mat picture = item.page(cv::Rect(0, 0, in.width_px, in.height_px));
  Overlay overlay(picture, in, 1);
  overlay.Goal(config_.p_CO_C_star, config_.radius);
  overlay.Detection(item.detection);
  const int y = in.height_px + 19;
  DrawText(item.page, fmt::format("t = {:.3f} s", static_cast<double>(item.stamp_ns) * 1e-9), 10, y, 0.45,
           kTruthColour);
  DrawText(item.page, "dashed: goal", in.width_px / 3, y, 0.45, kGoalColour);
  std::string words = "no detection";
  if (item.detection.found) {
    const double error_px = std::hypot(in.U(item.detection.s) - in.U(config_.p_CO_C_star),
                                       in.V(item.detection.s) - in.V(config_.p_CO_C_star));
    words = fmt::format("detection, {:.1f} px off", error_px);
  }
  DrawText(item.page, words, 2 * in.width_px / 3, y, 0.45, kDetectionColour);
}

void EyeFilm::Encode() {
  linux_rt::MakeThreadYielding("fovea-film");
  try {
    while (true) {
      Item item;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return closed_ || !items_.empty(); });
        if (items_.empty()) {
          return;
        }
        item = std::move(items_.front());
        items_.pop_front();
      }
      changed_.notify_all();
      Draw(item);
      file_.Add(item.page, item.stamp_ns);
      const std::lock_guard lock(mutex_);
      spare_.push_back(std::move(item.page));
    }
  } catch (...) {
    {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
    }
    changed_.notify_all();
  }
}

void EyeFilm::Finish() {
  Close();
  if (failure_) {
    std::rethrow_exception(failure_);
  }
  file_.Finish();
}

std::uint64_t EyeFilm::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace fovea::sim
