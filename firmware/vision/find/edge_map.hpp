// SPDX-License-Identifier: Apache-2.0
// Edges of an image, or of a part of it: points with sub-pixel accuracy, linked to chains.
//
// The image is first reduced by averaging squares of pixels, which removes most of the noise and saves most
// of the time. With a colour model, each mean becomes its likeness to the target's colour. Edges are the
// ridges of the gradient above its noise. Chains follow the ridges and end where their direction jumps.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "firmware/vision/find/colour_model.hpp"
#include "firmware/vision/picture.hpp"

namespace fovea::vision {

struct EdgePoint {
  float u_px = 0.0F;  // in the whole image
  float v_px = 0.0F;
  float gu = 0.0F;  // unit vector towards the brighter side (with a colour model: the likelier one)
  float gv = 0.0F;
};

class EdgeMap {
 public:
  // Finds edges in `area` of `image` (CV_8UC3 BGR or CV_8UC1), reduced by `factor` (2 or 4). Without
  // `colour`, or in a gray image, uses the brightness of the strongest channel. Allocates when the area is
  // larger, or has more edges, than any before.
  void Find(const Picture& image, const cv::Rect& area, int factor, const ColourModel* colour);

  [[nodiscard]] int chain_count() const { return static_cast<int>(chain_ends_.size()); }
  [[nodiscard]] std::span<const EdgePoint> Chain(int index) const;
  // All points, chain by chain.
  [[nodiscard]] std::span<const EdgePoint> points() const { return points_; }
  // Pixels of the image per pixel of the reduced image, along each axis.
  [[nodiscard]] int factor() const { return factor_; }

 private:
  void Reduce(const Picture& image, const cv::Rect& area, const ColourModel* colour);
  template <std::size_t kFactor, std::size_t kChannels>
  void ReduceBy(const Picture& image, const cv::Rect& area, const ColourModel* colour);
  void FindGradient();
  [[nodiscard]] float NoiseOfGradient();
  void ForgetRidges();
  void FindRidges(const cv::Rect& area);
  void Link();
  [[nodiscard]] int Next(int index, float along_u, float along_v) const;

  struct Ridge {
    EdgePoint point;
    int x = 0;
    int y = 0;
    bool strong = false;
    bool used = false;
  };

  int factor_ = 4;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint16_t> rows_;          // sums of `factor` rows
  std::vector<std::uint8_t> small_;          // [height x width]
  std::vector<std::int16_t> down_, across_;  // a row's sums and differences of three
  std::vector<std::int16_t> dx_, dy_;        // Sobel's gradient
  std::vector<std::int32_t> size2_;          // its squared length
  std::vector<std::int32_t> sample_;         // of size2_, for the noise
  std::vector<std::int32_t> ridge_at_;       // index in ridges_, or -1
  std::vector<std::size_t> ridge_places_;    // where ridge_at_ is not -1
  std::vector<Ridge> ridges_;
  std::vector<EdgePoint> points_;
  std::vector<int> chain_ends_;
  std::vector<int> forward_, backward_;  // of the chain being linked
};

}  // namespace fovea::vision
