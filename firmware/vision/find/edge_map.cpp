// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/find/edge_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fovea::vision {
namespace {

// Sobel's response to a sharp step of 1 is 4; to a step blurred over two pixels, about 3.
constexpr float kWeakestEdge = 6.0F * 3.0F;  // a step of 6 gray levels
constexpr float kNoiseStrong = 4.8F;         // starts a chain [standard deviations of the gradient]
constexpr float kNoiseWeak = 2.8F;           // continues a chain
constexpr std::size_t kShortestChain = 6;
constexpr float kSameDirection = 0.55F;  // least cosine between neighbours' gradients

struct Offset {
  int x;
  int y;
  float ux;
  float uy;
};
constexpr float kR2 = 0.70710678F;  // 1 / sqrt(2)
constexpr float kR5 = 0.44721360F;  // 1 / sqrt(5)
constexpr std::array<Offset, 8> kNearOffsets{{{1, 0, 1, 0},
                                              {1, 1, kR2, kR2},
                                              {0, 1, 0, 1},
                                              {-1, 1, -kR2, kR2},
                                              {-1, 0, -1, 0},
                                              {-1, -1, -kR2, -kR2},
                                              {0, -1, 0, -1},
                                              {1, -1, kR2, -kR2}}};
constexpr std::array<Offset, 16> kFar{{{2, 0, 1, 0},
                                       {2, 1, 2 * kR5, kR5},
                                       {2, 2, kR2, kR2},
                                       {1, 2, kR5, 2 * kR5},
                                       {0, 2, 0, 1},
                                       {-1, 2, -kR5, 2 * kR5},
                                       {-2, 2, -kR2, kR2},
                                       {-2, 1, -2 * kR5, kR5},
                                       {-2, 0, -1, 0},
                                       {-2, -1, -2 * kR5, -kR5},
                                       {-2, -2, -kR2, -kR2},
                                       {-1, -2, -kR5, -2 * kR5},
                                       {0, -2, 0, -1},
                                       {1, -2, kR5, -2 * kR5},
                                       {2, -2, kR2, -kR2},
                                       {2, -1, 2 * kR5, -kR5}}};

std::size_t At(int x, int y, int width) { return static_cast<std::size_t>(y * width + x); }

}  // namespace

std::span<const EdgePoint> EdgeMap::Chain(int index) const {
  const int begin = index == 0 ? 0 : chain_ends_[static_cast<std::size_t>(index - 1)];
  const int end = chain_ends_[static_cast<std::size_t>(index)];
  return std::span(points_).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
}

void EdgeMap::Find(const Picture& image, const cv::Rect& area, int factor, const ColourModel* colour) {
  factor_ = factor;
  width_ = area.width / factor;
  height_ = area.height / factor;
  points_.clear();
  chain_ends_.clear();
  ridges_.clear();
  if (width_ < 5 || height_ < 5) {
    return;
  }
  Reduce(image, area, colour);
  FindGradient();
  FindRidges(area);
  Link();
}

void EdgeMap::Reduce(const Picture& image, const cv::Rect& area, const ColourModel* colour) {
  image.Need(area);
  const bool gray = image.channels() == 1;
  if (factor_ == 4) {
    gray ? ReduceBy<4, 1>(image, area, colour) : ReduceBy<4, 3>(image, area, colour);
  } else {
    gray ? ReduceBy<2, 1>(image, area, colour) : ReduceBy<2, 3>(image, area, colour);
  }
}

// Factor and channels are compile-time constants: this takes a third of the time.
template <std::size_t kFactor, std::size_t kChannels>
void EdgeMap::ReduceBy(const Picture& image, const cv::Rect& area, const ColourModel* colour) {
  constexpr unsigned kArea = kFactor * kFactor;
  constexpr std::size_t kStep = kFactor * kChannels;
  const std::size_t bytes = static_cast<std::size_t>(width_) * kStep;
  rows_.resize(bytes);
  small_.resize(static_cast<std::size_t>(width_ * height_));
  for (int y = 0; y < height_; ++y) {
    const std::uint8_t* row[kFactor];
    for (std::size_t k = 0; k < kFactor; ++k) {
      row[k] = image.ptr<std::uint8_t>(area.y + y * factor_ + static_cast<int>(k)) +
               static_cast<std::size_t>(area.x) * kChannels;
    }
    std::uint16_t* sums = rows_.data();
    for (std::size_t i = 0; i < bytes; ++i) {
      unsigned sum = 0;
      for (std::size_t k = 0; k < kFactor; ++k) {
        sum += row[k][i];
      }
      sums[i] = static_cast<std::uint16_t>(sum);
    }
    std::uint8_t* out = &small_[At(0, y, width_)];
    for (int x = 0; x < width_; ++x, sums += kStep) {
      unsigned mean[kChannels] = {};
      for (std::size_t i = 0; i < kStep; ++i) {
        mean[i % kChannels] += sums[i];
      }
      if constexpr (kChannels == 1) {
        out[x] = static_cast<std::uint8_t>(mean[0] / kArea);
      } else {
        // Without a colour model, the strongest channel: a saturated target of any hue is bright in it.
        out[x] = colour != nullptr ? colour->Likeness(mean[0] / kArea, mean[1] / kArea, mean[2] / kArea)
                                   : static_cast<std::uint8_t>(std::max({mean[0], mean[1], mean[2]}) / kArea);
      }
    }
  }
}

void EdgeMap::FindGradient() {
  const std::size_t count = small_.size();
  dx_.resize(count);
  dy_.resize(count);
  size2_.resize(count);
  const auto clear = [&](std::size_t i) { dx_[i] = dy_[i] = 0, size2_[i] = 0; };
  for (int x = 0; x < width_; ++x) {
    clear(At(x, 0, width_));
    clear(At(x, height_ - 1, width_));
  }
  // Sobel's sums, vertical first: all numbers fit into 16 bits, eight per vector instruction.
  down_.resize(static_cast<std::size_t>(width_));
  across_.resize(static_cast<std::size_t>(width_));
  for (int y = 1; y + 1 < height_; ++y) {
    clear(At(0, y, width_));
    clear(At(width_ - 1, y, width_));
    const std::uint8_t* a = &small_[At(0, y - 1, width_)];
    const std::uint8_t* b = a + width_;
    const std::uint8_t* c = b + width_;
    // __restrict: the rows do not overlap, so the compiler can take eight pixels at a time.
    std::int16_t* __restrict down = down_.data();
    std::int16_t* __restrict across = across_.data();
    for (int x = 0; x < width_; ++x) {
      down[x] = static_cast<std::int16_t>(a[x] + 2 * b[x] + c[x]);
      across[x] = static_cast<std::int16_t>(c[x] - a[x]);
    }
    std::int16_t* __restrict dx = &dx_[At(0, y, width_)];
    std::int16_t* __restrict dy = &dy_[At(0, y, width_)];
    std::int32_t* __restrict size2 = &size2_[At(0, y, width_)];
    for (int x = 1; x < width_ - 1; ++x) {
      dx[x] = static_cast<std::int16_t>(down[x + 1] - down[x - 1]);
      dy[x] = static_cast<std::int16_t>(across[x - 1] + 2 * across[x] + across[x + 1]);
    }
    for (int x = 1; x < width_ - 1; ++x) {
      size2[x] = dx[x] * dx[x] + dy[x] * dy[x];
    }
  }
}

// Standard deviation of the gradient along one axis due to noise. Most of an image has no edge, so the median
// of the squared length measures it; for the sum of two squared normal variables the median is 1.386.
float EdgeMap::NoiseOfGradient() {
  constexpr std::size_t kEvery = 13;
  sample_.clear();
  for (std::size_t i = 0; i < size2_.size(); i += kEvery) {
    sample_.push_back(size2_[i]);
  }
  const auto middle = sample_.begin() + static_cast<std::ptrdiff_t>(sample_.size() / 2);
  std::nth_element(sample_.begin(), middle, sample_.end());
  return std::sqrt(static_cast<float>(*middle) / 1.386F);
}

// Sets ridge_at_ to -1: only where the last ridges were, or everywhere if the size changed.
void EdgeMap::ForgetRidges() {
  if (ridge_at_.size() != small_.size()) {
    ridge_at_.assign(small_.size(), -1);
  } else {
    for (const std::size_t place : ridge_places_) {
      ridge_at_[place] = -1;
    }
  }
  ridge_places_.clear();
}

void EdgeMap::FindRidges(const cv::Rect& area) {
  const float noise = NoiseOfGradient();
  const float strong = std::max(kWeakestEdge, kNoiseStrong * noise);
  const float weak = std::max(0.6F * kWeakestEdge, kNoiseWeak * noise);
  const auto weak2 = static_cast<std::int32_t>(weak * weak);
  ForgetRidges();
  const auto scale = static_cast<float>(factor_);
  const float middle = 0.5F * (scale - 1.0F);
  for (int y = 1; y + 1 < height_; ++y) {
    for (int x = 1; x + 1 < width_; ++x) {
      const std::size_t i = At(x, y, width_);
      // Most of a picture has no edge: skip eight pixels at a time.
      constexpr int kTogether = 8;
      if (x + kTogether < width_) {
        int edges = 0;
        for (std::size_t k = 0; k < kTogether; ++k) {
          edges -= static_cast<int>(size2_[i + k] >= weak2);
        }
        if (edges == 0) {
          x += kTogether - 1;
          continue;
        }
      }
      const std::int32_t m2 = size2_[i];
      if (m2 < weak2) {
        continue;
      }
      // Choose the neighbours across the edge: horizontal, vertical or on a diagonal.
      const int gx = dx_[i];
      const int gy = dy_[i];
      const int ax = std::abs(gx);
      const int ay = std::abs(gy);
      int ox = 1;
      int oy = 0;
      if (5 * ay > 12 * ax) {
        ox = 0;
        oy = 1;
      } else if (5 * ax <= 12 * ay) {
        oy = (gx > 0) == (gy > 0) ? 1 : -1;
      }
      const std::int32_t before = size2_[At(x - ox, y - oy, width_)];
      const std::int32_t after = size2_[At(x + ox, y + oy, width_)];
      if (m2 <= before || m2 < after) {
        continue;
      }
      const float size = std::sqrt(static_cast<float>(m2));
      const float low = std::sqrt(static_cast<float>(before));
      const float high = std::sqrt(static_cast<float>(after));
      const float shift = 0.5F * (high - low) / std::max(2.0F * size - low - high, 1e-3F);
      const float gu = static_cast<float>(gx) / size;
      const float gv = static_cast<float>(gy) / size;
      // Offset of the parabola's maximum along that line, projected across the edge.
      const float across =
          std::clamp(shift, -0.5F, 0.5F) * (static_cast<float>(ox) * gu + static_cast<float>(oy) * gv);
      Ridge ridge;
      ridge.point.u_px = static_cast<float>(area.x) + scale * (static_cast<float>(x) + across * gu) + middle;
      ridge.point.v_px = static_cast<float>(area.y) + scale * (static_cast<float>(y) + across * gv) + middle;
      ridge.point.gu = gu;
      ridge.point.gv = gv;
      ridge.x = x;
      ridge.y = y;
      ridge.strong = size >= strong;
      ridge_at_[i] = static_cast<std::int32_t>(ridges_.size());
      ridge_places_.push_back(i);
      ridges_.push_back(ridge);
    }
  }
}

// The best ridge to continue with from ridge `index` in direction (along_u, along_v), or -1.
int EdgeMap::Next(int index, float along_u, float along_v) const {
  const Ridge& here = ridges_[static_cast<std::size_t>(index)];
  const auto search = [&](std::span<const Offset> offsets, float min_along) {
    int best = -1;
    float best_score = 0.0F;
    for (const Offset& o : offsets) {
      const float along = o.ux * along_u + o.uy * along_v;
      const int x = here.x + o.x;
      const int y = here.y + o.y;
      if (along < min_along || x < 0 || y < 0 || x >= width_ || y >= height_) {
        continue;
      }
      const int candidate = ridge_at_[At(x, y, width_)];
      if (candidate < 0 || ridges_[static_cast<std::size_t>(candidate)].used) {
        continue;
      }
      const EdgePoint& p = ridges_[static_cast<std::size_t>(candidate)].point;
      const float same = p.gu * here.point.gu + p.gv * here.point.gv;
      const float score = same + 0.5F * along;
      if (same >= kSameDirection && score > best_score) {
        best = candidate;
        best_score = score;
      }
    }
    return best;
  };
  const int near = search(kNearOffsets, 0.3F);
  return near >= 0 ? near : search(kFar, 0.75F);
}

void EdgeMap::Link() {
  for (std::size_t seed = 0; seed < ridges_.size(); ++seed) {
    if (!ridges_[seed].strong || ridges_[seed].used) {
      continue;
    }
    const auto follow = [&](float sign, std::vector<int>& list) {
      list.clear();
      int at = static_cast<int>(seed);
      while (true) {
        const EdgePoint& p = ridges_[static_cast<std::size_t>(at)].point;
        at = Next(at, -sign * p.gv, sign * p.gu);
        if (at < 0) {
          return;
        }
        ridges_[static_cast<std::size_t>(at)].used = true;
        list.push_back(at);
      }
    };
    ridges_[seed].used = true;
    follow(1.0F, forward_);
    follow(-1.0F, backward_);
    if (forward_.size() + backward_.size() + 1 < kShortestChain) {
      continue;
    }
    // Store the points in the order that has the brighter side on the left, seen with v downwards.
    for (auto i = backward_.rbegin(); i != backward_.rend(); ++i) {
      points_.push_back(ridges_[static_cast<std::size_t>(*i)].point);
    }
    points_.push_back(ridges_[seed].point);
    for (const int i : forward_) {
      points_.push_back(ridges_[static_cast<std::size_t>(i)].point);
    }
    chain_ends_.push_back(static_cast<int>(points_.size()));
  }
}

}  // namespace fovea::vision
