// SPDX-License-Identifier: Apache-2.0
// Second stage of finding a sphere or disc: the accurate curve. Measures edges along lines across the curve
// (profiles.hpp), then fits the curve to them by robust weighted least squares, in a few rounds.
#pragma once

#include "firmware/vision/detector_config.hpp"
#include "firmware/vision/find/curve.hpp"
#include "firmware/vision/fit/profiles.hpp"
#include "firmware/vision/picture.hpp"

namespace fovea::vision {

template <class Curve>
struct CurveFit {
  bool converged = false;
  Curve curve;
  Eigen::Matrix<double, Curve::kDim, Curve::kDim> cov =
      Eigen::Matrix<double, Curve::kDim, Curve::kDim>::Zero();
  Ellipse ellipse;
  double rms_px = 0.0;    // of the edges' distances from the curve
  double noise_px = 0.0;  // part of rms_px that the image's noise explains
  double contrast = 0.0;  // mean step across the curve [gray levels]
  double seen = 0.0;      // share of the curve that is inside the image and on an edge
  double blur_px = 0.0;
};

// Reuses the working memory of a fit. For one thread.
class CurveFitter {
 public:
  explicit CurveFitter(const EdgeNoise& edge_noise) : edge_noise_(edge_noise) {}
  // Fits the curve near `start`, which may be about 2 px off. `shaded`: the outline is a ball's, whose
  // brightness falls off towards it.
  template <class Curve>
  CurveFit<Curve> Fit(const Picture& image, const Intrinsics& in, const Curve& start, bool shaded);

 private:
  template <class Curve>
  bool Approach(const Picture& image, const Intrinsics& in, int most, int rounds, double still_px,
                bool shaded, CurveFit<Curve>& fit);
  template <class Curve>
  bool ReadLines(const Picture& image, const Intrinsics& in, const Curve& curve, int most);
  template <class Curve>
  bool MakeRows(const Intrinsics& in, const Curve& curve);
  template <int kN>
  double Residuals(const Eigen::Matrix<double, kN, 1>& p);
  template <int kN>
  bool Solve(Eigen::Matrix<double, kN, 1>& p);
  template <class Curve>
  bool Describe(CurveFit<Curve>& fit);
  template <class Curve>
  bool Place(const Intrinsics& in, const Curve& curve);

  void FindHidden(double spacing_px);

  // row . p - rhs is an edge's distance from the curve [px].
  struct Row {
    std::array<double, EllipseCurve::kDim> row;
    double rhs = 0.0;
    double root_info = 0.0;  // 1 / standard deviation [1/px]
    std::size_t line = 0;
  };

  const EdgeNoise edge_noise_;
  Profiles profiles_;
  std::array<ProfileLine, Profiles::kMaxLines> lines_;
  int count_ = 0;
  std::array<double, Profiles::kMaxLines> at_px_{};
  std::array<double, Profiles::kMaxLines> weight_{};
  std::array<bool, Profiles::kMaxLines> hidden_{};
  std::array<Row, Profiles::kMaxLines> rows_;
  std::size_t row_count_ = 0;
  std::array<double, Profiles::kMaxLines> residual_{};
  std::array<double, Profiles::kMaxLines> size_{};
};

}  // namespace fovea::vision
