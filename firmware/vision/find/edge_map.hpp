// Where an image, or a part of it, has edges: points to a fraction of a pixel, linked to chains.
//
// First the image is made smaller by averaging squares of pixels, which takes most of the noise and of the
// time; by colour, each mean is replaced by how much it looks like the target. Edges are the ridges of the
// gradient there, above what its noise would give. Chains follow them and end where their direction jumps.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "firmware/vision/find/colour_model.hpp"

namespace fovea::vision {

struct EdgePoint {
  float u_px = 0.0F;  // in the whole image
  float v_px = 0.0F;
  float gu = 0.0F;  // unit vector, towards the brighter side (by colour: the likelier)
  float gv = 0.0F;
};

class EdgeMap {
 public:
  // Looks at `area` of `image` (CV_8UC3 BGR or CV_8UC1), `factor` (2 or 4) times smaller. Without `colour`,
  // or when the image is gray, by brightness: of its strongest channel. Allocates when it is larger than any
  // before.
  void Find(const cv::Mat& image, const cv::Rect& area, int factor, const ColourModel* colour);

  [[nodiscard]] int chain_count() const { return static_cast<int>(chain_ends_.size()); }
  [[nodiscard]] std::span<const EdgePoint> Chain(int index) const;
  // All of them, chain by chain.
  [[nodiscard]] std::span<const EdgePoint> points() const { return points_; }
  // Of its pixels in the image's.
  [[nodiscard]] int factor() const { return factor_; }

 private:
  void Reduce(const cv::Mat& image, const cv::Rect& area, const ColourModel* colour);
  template <std::size_t kFactor, std::size_t kChannels>
  void ReduceBy(const cv::Mat& image, const cv::Rect& area, const ColourModel* colour);
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
  std::vector<std::int16_t> dx_, dy_;        // Sobel's sums
  std::vector<std::int32_t> size2_;          // their squared length
  std::vector<std::int32_t> sample_;         // of size2_, for the noise
  std::vector<std::int32_t> ridge_at_;       // index in ridges_, or -1
  std::vector<std::size_t> ridge_places_;    // where ridge_at_ is not -1
  std::vector<Ridge> ridges_;
  std::vector<EdgePoint> points_;
  std::vector<int> chain_ends_;
  std::vector<int> forward_, backward_;  // of the chain being linked
};

}  // namespace fovea::vision
