// SPDX-License-Identifier: Apache-2.0
// Measures the position of an edge from the brightness along short lines across an outline.
//
// Along a line the brightness goes from the level inside to the level outside like a blurred step. The
// outline is known to about a pixel. The least-squares filter for the step's offset from there is the
// derivative of the step, with both levels estimated too. It reaches the Cramer-Rao bound; the position of
// the steepest gradient does not. The blur is the same for all lines and is estimated from all of them. The
// levels come from a line and, in noise, from its neighbours. A blurred outline of curvature k looks smaller
// by blur^2 k / 2; this is corrected. The fall-off of a ball's brightness towards its edge is fitted over all
// lines (shading.cpp) and subtracted.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "firmware/vision/intrinsics.hpp"
#include "firmware/vision/picture.hpp"

namespace fovea::vision {

// The blur of an edge in a fit of an outline [px].
inline constexpr double kStartBlurPx = 1.8;  // wide, because the start may be off
inline constexpr double kMinBlurPx = 0.45;   // from the pixel's width and the interpolation
inline constexpr double kMaxBlurPx = 3.0;
inline constexpr double kStillPx = 0.003;  // a round that moves the outline less is the last

// A line across the outline: a point on the outline, in ideal pixels, and the outward direction.
struct ProfileLine {
  double u_px = 0.0;
  double v_px = 0.0;
  double nu = 0.0;  // unit vector
  double nv = 0.0;
  double curvature = 0.0;  // of the outline there [1/px]
};

class Profiles {
 public:
  static constexpr int kMaxLines = 256;
  static constexpr int kHalf = 8;  // samples on each side, one per pixel
  static constexpr int kSamples = 2 * kHalf + 1;

  // The measurement of one line's edge.
  struct Edge {
    bool valid = false;
    double at_px = 0.0;  // position of the step along the line, from its point
    double info = 0.0;   // variance of at_px is noise^2 / info [gray levels^2/px^2]
    double contrast = 0.0;
    double step = 0.0;      // level inside minus level outside
    double variance = 0.0;  // of its samples about the step [gray levels^2]
  };

  // Reads the image along `count` lines. `closed`: the last line and the first are neighbours.
  void Read(const Picture& image, const Intrinsics& in, const ProfileLine* lines, int count, bool closed);

  // Measures all edges. `at_px[i]` is where the outline is expected to cross line i; `blur_px` the standard
  // deviation of the blur; `weight[i]` the weight of line i in the last fit, 0 to 1.
  void Measure(const std::array<double, kMaxLines>& at_px, const std::array<double, kMaxLines>& weight,
               double blur_px);

  // Fits how the surface of a ball with outline radius `radius_px` darkens towards its edge.
  void FitShading(const std::array<double, kMaxLines>& at_px, const std::array<double, kMaxLines>& weight,
                  double radius_px, double blur_px);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const Edge& edge(int i) const { return edges_[static_cast<std::size_t>(i)]; }
  // Correction of the blur, from the last Measure [px].
  [[nodiscard]] double blur_change_px() const { return blur_change_; }
  [[nodiscard]] double noise() const {
    return noise_;
  }  // median over the lines of the samples' standard deviation about the step [gray levels]
  [[nodiscard]] bool shaded() const { return shaded_; }  // the last FitShading found shading
  // The image's noise alone, measured roughly away from the edge [gray levels].
  [[nodiscard]] double quiet() const { return quiet_; }

 private:
  void ProjectColours(bool closed);
  void MeasureQuiet();

  // Blurred steps of different lines differ only by their position between two samples. Each of kPhases
  // positions is computed once, which saves five sixths of Measure's time.
  static constexpr int kPhases = 16;
  static constexpr int kMostUsed = 2 * kHalf;
  static constexpr int kPad = 5;  // zeros beside a line's samples, so that all windows have one length

  // Sums of products of a step's samples: q, p = 1 - q, d density, b wider, z turn.
  struct Sums {
    double n = 0.0, q = 0.0, qq = 0.0;
    double d = 0.0, dq = 0.0, dd = 0.0;
    double b = 0.0, bq = 0.0, bb = 0.0;
    double z = 0.0, zq = 0.0, zd = 0.0, zb = 0.0, zz = 0.0;
    double p = 0.0, qp = 0.0, pp = 0.0;
    double left = 0.0;  // part of dd that is independent of the two levels
  };
  struct Step {
    alignas(16) std::array<float, kMostUsed> used{};     // 1 near the edge, else 0
    alignas(16) std::array<float, kMostUsed> q{};        // the step, 1 inside to 0 outside
    alignas(16) std::array<float, kMostUsed> density{};  // derivative by an outward shift
    alignas(16) std::array<float, kMostUsed> wider{};    // derivative by the blur
    alignas(16) std::array<float, kMostUsed> turn{};     // SurfaceTurn of a ball times q
    Sums whole;
  };
  // Normal equations of the levels inside and outside.
  struct Levels {
    double qq = 0.0, qp = 0.0, pp = 0.0, yq = 0.0, yp = 0.0;
    [[nodiscard]] double Det() const { return qq * pp - qp * qp; }
    [[nodiscard]] double Inside(double det) const { return (pp * yq - qp * yp) / det; }
    [[nodiscard]] double Outside(double det) const { return (qq * yp - qp * yq) / det; }
    void Add(double w, const Levels& o) {
      qq += w * o.qq;
      qp += w * o.qp;
      pp += w * o.pp;
      yq += w * o.yq;
      yp += w * o.yp;
    }
  };
  // Sums over colours outside of a line, for their covariance.
  struct Background {
    float count = 0.0F;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
    void Add(const Eigen::Vector3f& colour) {
      count += 1.0F;
      sum += colour;
      squares += colour * colour.transpose();
    }
    void Add(const Background& o) {
      count += o.count;
      sum += o.sum;
      squares += o.squares;
    }
    [[nodiscard]] Eigen::Matrix3f Covariance() const {
      const float n = std::max(count, 1.0F);
      return squares / n - (sum / n) * (sum / n).transpose();
    }
  };
  // Products of a line's samples y, minus the shading, with the step's samples.
  struct Line {
    bool used = false;
    double at_px = 0.0;  // position of the step
    const Sums* step = nullptr;
    Levels levels;
    double y = 0.0, yq = 0.0, yd = 0.0, yb = 0.0, yy = 0.0;
  };

  void MakeSteps(double blur_px);
  static Sums Products(const Step& step, int from, int to);
  void Multiply(std::size_t k, double at_px, double blur_px);

  int count_ = 0;
  bool closed_ = true;
  bool gray_ = true;
  bool shaded_ = false;
  double radius_px_ = 0.0;
  double noise_ = 1.0;
  double quiet_ = 1.0;
  double blur_change_ = 0.0;
  std::array<ProfileLine, kMaxLines> lines_;
  // Brightness along the colour step, minus a common level.
  std::array<std::array<float, kPad + kSamples + kPad + 1>, kMaxLines> value_{};
  std::array<std::array<float, 3 * kSamples>, kMaxLines> colour_;
  std::array<Background, kMaxLines> background_;
  Eigen::Vector3f surface_ = Eigen::Vector3f::Zero();  // mean colour inside, of length 1
  std::array<double, kMaxLines> along_{};              // component of surface_ along a line's colour step
  std::array<bool, kMaxLines> readable_{};
  std::array<double, kMaxLines> shade_{};  // of each line: slope of the brightness in z
  int half_ = 0;                           // samples of a step, each way
  std::array<Step, kPhases> steps_;
  std::array<Line, kMaxLines> measured_;
  std::array<Sums, kMaxLines> cut_;  // of a step whose window extends beyond the line
  std::array<Edge, kMaxLines> edges_;
};

}  // namespace fovea::vision
