// The scenario's camera on the network: what the eye sees, as a GigE Vision camera sends it, with the
// faults that it has.
#pragma once

#include <memory>
#include <string>

#include "sim/app/eye.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/wire/gige_camera.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class NetworkEye {
 public:
  // `about` must outlive it, and it must outlive what `world` does next. std::runtime_error: no picture can
  // be drawn here, or GigeCamera refuses.
  NetworkEye(const RunDescription& about, World& world, const std::string& address,
             const std::string& serial);

  // After each step of the world. `wait`: for what is due to leave.
  void Advance(bool wait) { gige_->Advance(world_.now_ns(), wait); }
  [[nodiscard]] std::uint64_t sent() const { return gige_->sent(); }
  // Why there are no pictures any more; "" while there are.
  [[nodiscard]] std::string fault() const { return eye_.camera().fault(); }

 private:
  World& world_;
  Eye eye_;
  FrameSpoiler faults_;
  std::unique_ptr<GigeCamera> gige_;
};

}  // namespace fovea::sim
