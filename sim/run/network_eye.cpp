// SPDX-License-Identifier: Apache-2.0
#include "sim/run/network_eye.hpp"

#include <optional>
#include <utility>

#include "sim/scenario/compose.hpp"
#include "sim/scenario/fault_settings.hpp"

namespace fovea::sim {
namespace {

// More than the exposures within one transport time.
constexpr std::size_t kQueue = 8;
constexpr std::size_t kMostNews = 512;  // half a second of the robot's time

GigeCameraConfig MakeGigeConfig(const RunDescription& about, const std::string& address,
                                const std::string& serial) {
  const auto& camera = about.bench.camera;
  GigeCameraConfig config;
  config.address = address;
  config.serial = serial;
  config.width_px = about.pinhole.width_px;
  config.height_px = about.pinhole.height_px;
  config.rate_hz = camera.rate_hz;
  config.exposure_ns = static_cast<std::int64_t>(camera.exposure_ms * 1e6);
  config.transport_ns = static_cast<std::int64_t>(camera.latency_ms * 1e6);
  return config;
}

}  // namespace

NetworkEye::NetworkEye(const RunDescription& about, World& world, const std::string& address,
                       const std::string& serial, bool lockstep, WatchedCamera::Watcher watcher)
    : world_(world),
      lockstep_(lockstep),
      eye_(about, {.queue = kQueue}),
      watched_(eye_.camera(), std::move(watcher)),
      faults_(Seeded(about.scenario.faults.frames, SeedOf(about.scenario, RandomStream::kFrameFaults))),
      stamps_(about.stamps),
      on_the_way_(kMostNews) {
  news_.faults = about.scenario.faults.picture;
  gige_ = std::make_unique<GigeCamera>(watched_, MakeGigeConfig(about, address, serial));
  world.OnExposure([this](const Exposure& exposure) {
    std::optional<Exposure> taken = faults_.Spoil(exposure);
    if (taken) {
      taken->stamp_error_ns += stamps_.DriftNs(taken->stamp_ns);
      news_.late_ns = faults_.DelayNs(taken->stamp_ns) + stamps_.JitterNs(taken->sequence);
      news_.exposure = std::move(taken);
    }
  });
  if (!lockstep_) {
    courier_ = std::thread([this] { Run(); });
  }
}

NetworkEye::~NetworkEye() {
  closed_ = true;
  there_.release();
  if (courier_.joinable()) {
    courier_.join();
  }
}

void NetworkEye::Advance() {
  news_.now_ns = world_.now_ns();
  if (lockstep_) {
    Take(news_, /*wait=*/true);
  } else {
    const std::uint64_t before = on_the_way_.dropped();
    on_the_way_.Push(news_);
    dropped_ += news_.exposure ? on_the_way_.dropped() - before : 0;
    there_.release();
  }
  news_.exposure.reset();
}

void NetworkEye::SetFaults(const FaultSettings& faults) {
  faults_.SetFaults(faults.frames);
  news_.faults = faults.picture;
}

void NetworkEye::Take(const News& news, bool wait) {
  // The camera stamps its pictures by its own clock. They leave by the world's time.
  if (news.exposure && gige_->Expect(news.exposure->stamp_ns + news.exposure->stamp_error_ns,
                                     news.late_ns - news.exposure->stamp_error_ns)) {
    eye_.SetFaults(news.faults);
    eye_.camera().Expose(*news.exposure);
  }
  gige_->Advance(news.now_ns, wait);
}

// The threads that draw and send pictures may be preempted while they hold a lock. The robot's thread must
// not wait for them; this thread may.
void NetworkEye::Run() {
  while (!closed_) {
    there_.acquire();
    on_the_way_.Drain(on_the_way_.End(), [this](const News& news) { Take(news, /*wait=*/false); });
  }
}

}  // namespace fovea::sim
