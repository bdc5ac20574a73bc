// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/jitter/eye_chain.hpp"

#include <algorithm>

#include "firmware/vision/detect/vision_task.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "tools/bench/vision/picture.hpp"

namespace fovea::bench {
namespace {

constexpr std::int64_t kFrameNs = 33'333'333;
constexpr unsigned kPictures = 8;  // with different noise; shown in turns

PictureScene SceneAtGoal(const features::TargetFeature& feature, unsigned seed) {
  Body ball;
  ball.p = feature.p_CO_C_star;
  ball.radius = feature.radius;
  ball.shade = 0.3;
  PictureScene scene;
  scene.bodies.push_back(ball);
  scene.ground_swing = 10.0;
  scene.blur_px = 0.7;
  scene.noise = 3.0;
  scene.seed = seed;
  return scene;
}

vision::DetectorConfig DetectorFor(const features::TargetFeature& feature) {
  const PictureCamera camera;
  vision::DetectorConfig config;
  config.intrinsics = {camera.width_px, camera.height_px, camera.f_px,
                       camera.f_px,     camera.c_u_px,    camera.c_v_px};
  config.by = vision::FindBy::kGray;
  config.LookFor(feature);
  return config;
}

}  // namespace

// Delivers pictures in real time. A picture that nobody waits for is lost, as with a real camera.
class EyeChain::Camera final : public hal::Camera {
 public:
  explicit Camera(EyeChain& chain) : chain_(chain), start_ns_(clock_.NowNs()) {}

 private:
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override {
    constexpr std::int64_t kReadyNs = kExposureNs / 2 + kReadOutNs;  // after the middle of the exposure
    const std::int64_t now_ns = clock_.NowNs();
    const std::int64_t newest = (now_ns - start_ns_ - kReadyNs) / kFrameNs;
    next_ = std::max(next_, newest);
    const std::int64_t stamp_ns = start_ns_ + next_ * kFrameNs;
    if (stamp_ns + kReadyNs > now_ns + timeout_ns) {
      static_cast<void>(clock_.WaitUntil(now_ns + timeout_ns));
      return hal::Status(hal::StatusCode::kTimeout, "bench camera");
    }
    static_cast<void>(clock_.WaitUntil(stamp_ns + kReadyNs));
    const cv::Mat& picture = chain_.pictures_[static_cast<std::size_t>(next_) % chain_.pictures_.size()];
    frame.stamp_ns = stamp_ns;
    frame.exposure_ns = kExposureNs;
    frame.sequence = static_cast<std::uint64_t>(next_);
    frame.width_px = picture.cols;
    frame.height_px = picture.rows;
    frame.stride_bytes = picture.cols;
    frame.format = hal::PixelFormat::kMono8;
    frame.pixels = {picture.data, picture.total()};
    if (frame.sequence < chain_.seen_.size()) {
      chain_.seen_[frame.sequence].stamp_ns = stamp_ns;
      chain_.seen_[frame.sequence].arrived_ns = clock_.NowNs();
    }
    ++next_;
    return hal::Status::Ok();
  }

  EyeChain& chain_;
  linux_rt::MonotonicClock clock_;
  std::int64_t start_ns_;
  std::int64_t next_ = 0;
};

class EyeChain::Sink final : public hal::FeatureSink {
 public:
  explicit Sink(EyeChain& chain) : chain_(chain) {}
  void Put(const hal::FeatureMeasurement& measurement) noexcept override {
    if (measurement.sequence < chain_.seen_.size()) {
      chain_.seen_[measurement.sequence].detected_ns = clock_.NowNs();
    }
    chain_.mailbox_.Put(measurement);
  }

 private:
  EyeChain& chain_;
  linux_rt::MonotonicClock clock_;
};

EyeChain::EyeChain(const config::ServoConfig& config, std::size_t pictures)
    : config_(config), seen_(pictures), used_(pictures) {
  for (unsigned i = 0; i < kPictures; ++i) {
    pictures_.push_back(Draw(SceneAtGoal(config.feature, i + 1)));
  }
}

EyeChain::~EyeChain() { Stop(); }

void EyeChain::Start() {
  thread_ = std::thread([this] {
    linux_rt::MakeThreadYielding("fovea-vision");
    vision::VisionTask task(DetectorFor(config_.feature));
    Camera camera(*this);
    Sink sink(*this);
    static_cast<void>(vision::RunVision(camera, task, sink, stop_, {}));
  });
}

void EyeChain::Stop() {
  stop_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

void EyeChain::NoteUse(std::uint64_t sequence, std::int64_t woken_ns, std::int64_t written_ns) noexcept {
  if (sequence < used_.size()) {
    used_[sequence] = {woken_ns, written_ns};
  }
}

std::vector<HopTimes> EyeChain::Hops() const {
  std::vector<HopTimes> hops;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (seen_[i].arrived_ns > 0) {
      hops.push_back(seen_[i]);
      hops.back().woken_ns = used_[i].woken_ns;
      hops.back().written_ns = used_[i].written_ns;
    }
  }
  return hops;
}

}  // namespace fovea::bench
