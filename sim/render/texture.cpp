// SPDX-License-Identifier: Apache-2.0
#include "sim/render/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fovea::sim {
namespace {

// A pseudorandom number from 0 to 1 for a grid point.
float Hash(int x, int y, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9E3779B1U +
                    static_cast<std::uint32_t>(y) * 0x85EBCA77U + seed * 0xC2B2AE3DU;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  h ^= h >> 12;
  h *= 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<float>(h) * (1.0F / 4294967296.0F);
}

float Fade(float t) { return t * t * (3.0F - 2.0F * t); }

// Between the values at the four corners of a cell: low left, low right, high left, high right.
float Blend(float low_0, float low_1, float high_0, float high_1, float tx, float ty) {
  const float low = low_0 + tx * (low_1 - low_0);
  const float high = high_0 + tx * (high_1 - high_0);
  return low + ty * (high - low);
}

// Smooth noise with one wave per unit. Repeats after `period` units if that is above 0.
float Noise(float x, float y, std::uint32_t seed, int period = 0) {
  const float fx = std::floor(x);
  const float fy = std::floor(y);
  const float tx = Fade(x - fx);
  const float ty = Fade(y - fy);
  const auto at = [&](int dx, int dy) {
    int ix = static_cast<int>(fx) + dx;
    int iy = static_cast<int>(fy) + dy;
    if (period > 0) {
      ix = ((ix % period) + period) % period;
      iy = ((iy % period) + period) % period;
    }
    return Hash(ix, iy, seed);
  };
  return Blend(at(0, 0), at(1, 0), at(0, 1), at(1, 1), tx, ty);
}

// The largest whole number that is at most `x`; without SSE 4.1 much faster than std::floor.
int Floor(float x) {
  const int whole = static_cast<int>(x);
  return static_cast<float>(whole) > x ? whole - 1 : whole;
}

// The same noise with its grid's values computed once, for |x| <= `reach_x` and |y| <= `reach_y`: each value
// serves many pixels.
class NoiseGrid {
 public:
  NoiseGrid(float reach_x, float reach_y, std::uint32_t seed)
      : low_x_(-static_cast<int>(std::ceil(reach_x)) - 1),
        low_y_(-static_cast<int>(std::ceil(reach_y)) - 1),
        columns_(2 - 2 * low_x_) {
    for (int y = low_y_; y <= 1 - low_y_; ++y) {
      for (int x = low_x_; x <= 1 - low_x_; ++x) {
        values_.push_back(Hash(x, y, seed));
      }
    }
  }
  float At(float x, float y) const {
    const int column = Floor(x);
    const int row = Floor(y);
    const float tx = Fade(x - static_cast<float>(column));
    const float ty = Fade(y - static_cast<float>(row));
    const float* here = values_.data() + (row - low_y_) * columns_ + (column - low_x_);
    return Blend(here[0], here[1], here[columns_], here[columns_ + 1], tx, ty);
  }

 private:
  int low_x_;
  int low_y_;
  std::ptrdiff_t columns_;
  std::vector<float> values_;
};

using Colour = std::array<float, 3>;

Colour Mix(const Colour& a, const Colour& b, float t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

void Put(Texture& texture, int x, int y, const Colour& colour) {
  const auto at = (static_cast<std::size_t>(y) * static_cast<std::size_t>(texture.width_px) +
                   static_cast<std::size_t>(x)) *
                  4;
  for (std::size_t c = 0; c < 3; ++c) {
    const float level = std::clamp(colour[c], 0.0F, 1.0F) * 255.0F + 0.5F;
    texture.rgba[at + c] = static_cast<std::uint8_t>(level);
  }
  texture.rgba[at + 3] = 255;
}

Texture Blank(int width_px, int height_px) {
  return {width_px, height_px,
          std::vector<std::uint8_t>(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) *
                                    4)};
}

// Birch: fibres along x, broad bands, fine pores. For |x| <= `half_x` and |y| <= `half_y` [m].
class Birch {
 public:
  Birch(float half_x, float half_y)
      : warp_(3.0F * half_x, 5.0F * half_y, 1),
        band_(1.5F * half_x, 22.0F * (half_y + kWarp), 2),
        fibre_(14.0F * half_x, 420.0F * (half_y + kWarp), 3),
        pore_(60.0F * half_x, 900.0F * half_y, 4) {}
  Colour At(float x, float y) const {
    const float warp = kWarp * warp_.At(3.0F * x, 5.0F * y);
    const float band = band_.At(1.5F * x, 22.0F * (y + warp));
    const float fibre = fibre_.At(14.0F * x, 420.0F * (y + warp));
    const float pore = pore_.At(60.0F * x, 900.0F * y);
    const float tone = 0.55F * band + 0.30F * fibre + 0.15F * pore;
    return Mix({0.64F, 0.52F, 0.37F}, {0.80F, 0.69F, 0.52F}, tone);
  }

 private:
  static constexpr float kWarp = 0.02F;  // [m]

  NoiseGrid warp_;
  NoiseGrid band_;
  NoiseGrid fibre_;
  NoiseGrid pore_;
};

// 1 on a ruled line, 0 beside it, with soft edges. `pitch` and `half_width` in metres.
float Line(float x, float pitch, float half_width, float soft) {
  const float d = std::fabs(x - pitch * std::round(x / pitch));
  return 1.0F - std::clamp((d - half_width) / soft, 0.0F, 1.0F);
}

// A rubber mat: fine grain, thin lines every 10 mm, stronger ones every 50 mm. For positions from its centre,
// |x| <= `half_x` and |y| <= `half_y` [m]; `texel` is the size of a pixel there.
class Mat {
 public:
  Mat(float half_x, float half_y, float texel)
      : coarse_(260.0F * half_x, 260.0F * half_y, 5),
        fine_(900.0F * half_x, 900.0F * half_y, 6),
        texel_(texel) {}
  Colour At(float x, float y) const;

 private:
  NoiseGrid coarse_;
  NoiseGrid fine_;
  float texel_;
};

Colour Mat::At(float x, float y) const {
  const float grain = 0.6F * coarse_.At(260.0F * x, 260.0F * y) + 0.4F * fine_.At(900.0F * x, 900.0F * y);
  Colour colour = Mix({0.085F, 0.155F, 0.185F}, {0.135F, 0.215F, 0.245F}, grain);
  const float fine = std::max(Line(x, 0.01F, 0.0001F, texel_), Line(y, 0.01F, 0.0001F, texel_));
  const float strong = std::max(Line(x, 0.05F, 0.0005F, texel_), Line(y, 0.05F, 0.0005F, texel_));
  colour = Mix(colour, {0.30F, 0.42F, 0.46F}, 0.25F * fine);
  return Mix(colour, {0.48F, 0.60F, 0.62F}, 0.75F * strong);
}

}  // namespace

Texture MakeTableTop(int size_px, double width_m, double depth_m, double mat_x, double mat_y,
                     double mat_width, double mat_depth) {
  Texture texture = Blank(size_px, size_px);
  const auto texel = static_cast<float>(std::max(width_m, depth_m) / size_px);
  const Birch birch(0.5F * static_cast<float>(width_m), 0.5F * static_cast<float>(depth_m));
  const Mat rubber(0.5F * static_cast<float>(mat_width) + texel, 0.5F * static_cast<float>(mat_depth) + texel,
                   texel);
  const auto mat = [&rubber](float u, float v, float out) {
    return out > -0.006F ? Colour{0.08F, 0.10F, 0.11F} : rubber.At(u, v);
  };
  for (int j = 0; j < size_px; ++j) {
    for (int i = 0; i < size_px; ++i) {
      const auto x = static_cast<float>(((i + 0.5) / size_px - 0.5) * width_m);
      const auto y = static_cast<float>(((j + 0.5) / size_px - 0.5) * depth_m);
      const float u = x - static_cast<float>(mat_x);
      const float v = y - static_cast<float>(mat_y);
      // Distance to the mat's outline, negative inside.
      const float out = std::max(std::fabs(u) - 0.5F * static_cast<float>(mat_width),
                                 std::fabs(v) - 0.5F * static_cast<float>(mat_depth));
      if (out < -texel) {
        Put(texture, i, j, mat(u, v, out));
        continue;
      }
      Colour colour = birch.At(x, y);
      if (out < texel) {
        colour = Mix(mat(u, v, out), colour, std::clamp(out / texel + 0.5F, 0.0F, 1.0F));
      } else {
        colour = Mix({0.30F, 0.23F, 0.15F}, colour, std::clamp(out / 0.008F, 0.0F, 1.0F));  // its soft shadow
      }
      Put(texture, i, j, colour);
    }
  }
  return texture;
}

Texture MakeFloor(int size_px) {
  Texture texture = Blank(size_px, size_px);
  const auto size = static_cast<float>(size_px);
  for (int j = 0; j < size_px; ++j) {
    for (int i = 0; i < size_px; ++i) {
      const float u = (static_cast<float>(i) + 0.5F) / size;
      const float v = (static_cast<float>(j) + 0.5F) / size;
      const float cloud = 0.6F * Noise(8.0F * u, 8.0F * v, 7, 8) + 0.4F * Noise(64.0F * u, 64.0F * v, 8, 64);
      const float speck = Noise(size * 0.5F * u, size * 0.5F * v, 9, size_px / 2);
      Colour colour = Mix({0.33F, 0.34F, 0.35F}, {0.42F, 0.43F, 0.44F}, 0.7F * cloud + 0.3F * speck);
      const float edge = std::min({u, v, 1.0F - u, 1.0F - v});
      colour = Mix({0.22F, 0.225F, 0.23F}, colour, std::clamp((edge - 0.003F) * 300.0F, 0.0F, 1.0F));
      Put(texture, i, j, colour);
    }
  }
  return texture;
}

}  // namespace fovea::sim
