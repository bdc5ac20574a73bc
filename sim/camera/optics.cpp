// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/optics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

namespace fovea::sim {
namespace {

// Longest time from the first row of a band to the last. Targets and balls are drawn row by row and need only
// that they move uniformly within a band. All else stands still in a band and is off by at most half of this
// time, 0.1 px at 200 px/s.
constexpr double kBandNs = 1e6;

std::optional<LensMap> MakeLensMap(const Lens& lens, const Pinhole& pinhole, Sampling sampling) {
  return !NeedsLensMap(lens, pinhole) && sampling == Sampling::kPlain
             ? std::nullopt
             : std::make_optional<LensMap>(lens, pinhole);
}

std::optional<SensorRows> RowsOf(const Shutter& shutter, const Pinhole& pinhole, const Lens& lens) {
  if (shutter.row_time_ns == 0.0) {
    return std::nullopt;
  }
  return SensorRows{pinhole.FocalV(), pinhole.c_v_px, {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3}};
}

}  // namespace

Optics::Optics(const RenderScene& scene, const Pinhole& pinhole, const Lens& lens, Sampling sampling,
               int index, const Shutter& shutter, Optics* twin, RendererPool* pool)
    : shutter_(shutter),
      height_px_(pinhole.height_px),
      lens_(twin != nullptr ? twin->lens_ : MakeLensMap(lens, pinhole, sampling)),
      pool_(pool) {
  const Pinhole& drawn = lens_ ? lens_->wide() : pinhole;
  const std::optional<SensorRows> rows = RowsOf(shutter, pinhole, lens);
  SceneRenderer* const of_twin = twin != nullptr ? twin->renderer_.get() : nullptr;
  renderer_ = pool_ != nullptr
                  ? pool_->Take(scene, drawn, RenderQuality{}, index, rows, of_twin)
                  : std::make_unique<SceneRenderer>(scene, drawn, RenderQuality{}, index, rows, of_twin);
  if (lens_) {
    wide_.resize(static_cast<std::size_t>(lens_->wide().width_px) *
                 static_cast<std::size_t>(lens_->wide().height_px) * 4);
  }
}

Optics::~Optics() {
  if (pool_ != nullptr) {
    pool_->Give(std::move(renderer_));
  }
}

void Optics::Draw(const Exposure& exposure, std::span<std::uint8_t> rgba, Areas areas) {
  if (shutter_.IsSharp() || exposure.around == nullptr) {
    DrawSharp(exposure, areas, rgba);
    return;
  }
  const int count = shutter_.sub_exposures;
  if (count == 1) {
    DrawRows(exposure, shutter_.SubExposureNs(0), areas, rgba);
    return;
  }
  sum_.assign(rgba.size(), static_cast<std::uint16_t>(count / 2));  // rounds
  for (int k = 0; k < count; ++k) {
    const double offset_ns = shutter_.SubExposureNs(k);
    if (shutter_.row_time_ns > 0.0) {
      DrawRows(exposure, offset_ns, areas, rgba);
    } else {
      DrawSharp(exposure.At(std::llround(offset_ns)), areas, rgba);
    }
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      sum_[i] = static_cast<std::uint16_t>(sum_[i] + rgba[i]);
    }
  }
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    rgba[i] = static_cast<std::uint8_t>(sum_[i] / count);
  }
}

void Optics::DrawSharp(const Moment& moment, Areas areas, std::span<std::uint8_t> rgba) {
  if (!lens_) {
    renderer_->Draw(moment, moment.X_BC, rgba, areas);
    return;
  }
  renderer_->Draw(moment, moment.X_BC, wide_);
  lens_->Apply(wide_, rgba);
}

// Draws each row at its own time, plus `offset_ns`.
void Optics::DrawRows(const Exposure& exposure, double offset_ns, Areas areas, std::span<std::uint8_t> rgba) {
  const int rows = std::clamp(static_cast<int>(kBandNs / shutter_.row_time_ns), 1, height_px_);
  const auto at = [&](double row) {
    return exposure.At(std::llround(offset_ns + shutter_.EdgeNs(row, height_px_)));
  };
  RowBand band;
  band.last = at(0.0);
  for (int begin = 0; begin < height_px_; begin += rows) {
    const int end = std::min(begin + rows, height_px_);
    band.rows = end - begin;
    band.middle_row = 0.5 * (begin + end - 1);
    band.first = band.last;
    band.middle = at(0.5 * (begin + end));
    band.last = at(end);
    if (lens_) {
      std::tie(band.begin_px, band.end_px) = lens_->WideRows(begin, end);
      renderer_->DrawBand(band, wide_);
      lens_->ApplyRows(begin, end, wide_, rgba);
    } else {
      band.begin_px = begin;
      band.end_px = end;
      in_band_.clear();
      std::ranges::copy_if(areas, std::back_inserter(in_band_), [&](const PictureArea& area) {
        return area.top_px < end && area.top_px + area.height_px > begin;
      });
      if (areas.empty() || !in_band_.empty()) {
        renderer_->DrawBand(band, rgba, in_band_);
      }
    }
  }
}

}  // namespace fovea::sim
