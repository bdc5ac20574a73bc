#include "sim/app/network_eye.hpp"

#include <utility>

namespace fovea::sim {
namespace {

// More than are exposed within a transport time.
constexpr std::size_t kQueue = 8;

GigeCameraConfig MakeGigeConfig(const RunDescription& about, const std::string& address,
                                const std::string& serial) {
  const auto& camera = about.scenario.camera;
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
                       const std::string& serial)
    : world_(world), eye_(about, kQueue) {
  gige_ = std::make_unique<GigeCamera>(eye_.camera(), MakeGigeConfig(about, address, serial));
  world.OnExposure([this](Exposure exposure) {
    if (gige_->Expect(exposure.stamp_ns)) {
      eye_.camera().Expose(std::move(exposure));
    }
  });
}

}  // namespace fovea::sim
