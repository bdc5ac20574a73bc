// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/optics.hpp"

namespace fovea::sim {
namespace {

std::optional<LensMap> MakeLensMap(const Lens& lens, const Pinhole& pinhole, Sampling sampling) {
  return !NeedsLensMap(lens, pinhole) && sampling == Sampling::kPlain
             ? std::nullopt
             : std::make_optional<LensMap>(lens, pinhole);
}

}  // namespace

Optics::Optics(const RenderScene& scene, const Pinhole& pinhole, const Lens& lens, Sampling sampling,
               int index)
    : lens_(MakeLensMap(lens, pinhole, sampling)),
      renderer_(scene, lens_ ? lens_->wide() : pinhole, RenderQuality{}, index) {
  if (lens_) {
    wide_.resize(static_cast<std::size_t>(lens_->wide().width_px) *
                 static_cast<std::size_t>(lens_->wide().height_px) * 4);
  }
}

void Optics::Draw(const Exposure& exposure, std::span<std::uint8_t> rgba) {
  if (!lens_) {
    renderer_.Draw(exposure, exposure.X_BC, rgba);
    return;
  }
  renderer_.Draw(exposure, exposure.X_BC, wide_);
  lens_->Apply(wide_, rgba);
}

}  // namespace fovea::sim
