#include "sim/app/network_eye.hpp"

#include <optional>
#include <utility>

#include "sim/app/compose.hpp"
#include "sim/app/fault_settings.hpp"

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
    : world_(world),
      eye_(about, kQueue),
      faults_(MakeFrameFaults(about.scenario.faults, SeedOf(about.scenario, RandomStream::kFrameFaults))) {
  gige_ = std::make_unique<GigeCamera>(eye_.camera(), MakeGigeConfig(about, address, serial));
  world.OnExposure([this](const Exposure& exposure) {
    std::optional<Exposure> taken = faults_.Spoil(exposure);
    if (taken && gige_->Expect(taken->stamp_ns, faults_.DelayNs(taken->stamp_ns))) {
      eye_.camera().Expose(*std::move(taken));
    }
  });
}

}  // namespace fovea::sim
