// SPDX-License-Identifier: Apache-2.0
#include "sim/faults/picture_faults.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::sim {
namespace {

constexpr std::uint8_t kDark = 18;   // brightness of the occluder [gray levels]
constexpr double kGlareFades = 1.5;  // the glare ends at this multiple of its radius

void Mirror(int width_px, std::span<std::uint8_t> rgba) {
  const std::size_t row = static_cast<std::size_t>(4) * static_cast<std::size_t>(width_px);
  for (std::size_t begin = 0; begin < rgba.size(); begin += row) {
    for (std::size_t left = begin, right = begin + row - 4; left < right; left += 4, right -= 4) {
      const auto from = rgba.begin() + static_cast<std::ptrdiff_t>(left);
      std::swap_ranges(from, from + 4, rgba.begin() + static_cast<std::ptrdiff_t>(right));
    }
  }
}

// The pixels of one axis from `from` to `to`, within 0 .. size.
struct Pixels {
  Pixels(double from, double to, int size)
      : begin(static_cast<int>(std::clamp(std::ceil(from), 0.0, static_cast<double>(size)))),
        end(static_cast<int>(std::clamp(std::floor(to) + 1.0, 0.0, static_cast<double>(size)))) {}
  int begin;
  int end;
};

template <typename Change>
void ForPixels(const Pixels& columns, const Pixels& rows, int width_px, std::span<std::uint8_t> rgba,
               Change change) {
  for (int v = rows.begin; v < rows.end; ++v) {
    for (int u = columns.begin; u < columns.end; ++u) {
      const auto first =
          static_cast<std::size_t>(4) *
          (static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(u));
      for (std::size_t channel = 0; channel < 3; ++channel) {
        rgba[first + channel] = change(u, v, rgba[first + channel]);
      }
    }
  }
}

}  // namespace

void SpoilPicture(const PictureFaults& faults, std::int64_t stamp_ns, int width_px,
                  std::span<std::uint8_t> rgba) {
  const int height_px = static_cast<int>(rgba.size() / 4) / width_px;
  if (const auto& o = faults.occluder; o.window.Contains(stamp_ns)) {
    const Pixels columns(o.u_px - 0.5 * o.width_px, o.u_px + 0.5 * o.width_px, width_px);
    const Pixels rows(o.v_px - 0.5 * o.height_px, o.v_px + 0.5 * o.height_px, height_px);
    ForPixels(columns, rows, width_px, rgba, [](int, int, std::uint8_t) { return kDark; });
  }
  if (const auto& g = faults.glare; g.window.Contains(stamp_ns)) {
    const double far = kGlareFades * g.radius_px;
    ForPixels(Pixels(g.u_px - far, g.u_px + far, width_px), Pixels(g.v_px - far, g.v_px + far, height_px),
              width_px, rgba, [&](int u, int v, std::uint8_t value) {
                const double distance = std::hypot(u - g.u_px, v - g.v_px);
                const double light = std::clamp((far - distance) / (far - g.radius_px), 0.0, 1.0);
                return static_cast<std::uint8_t>(std::lround(value + light * (255.0 - value)));
              });
  }
  if (faults.mirror.Contains(stamp_ns)) {
    Mirror(width_px, rgba);
  }
}

}  // namespace fovea::sim
