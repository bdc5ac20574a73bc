// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/fit/curve_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/vision/fit/biweight.hpp"

namespace fovea::vision {
namespace {

constexpr int kMinLines = 40;
constexpr int kFewLines = 64;  // enough for the first approach
constexpr int kFewRounds = 6;
constexpr int kRounds = 4;  // with all lines
constexpr double kNearPx = 0.05;
constexpr double kOnCurvePx = 0.4;
constexpr double kShadedBlurPx = 1.5;
constexpr double kShadedPx = 0.03;  // common shift of the outline of a ball that is lit from one side

}  // namespace

template <class Curve>
bool CurveFitter::ReadLines(const Picture& image, const Intrinsics& in, const Curve& curve, int most) {
  const Eigen::Matrix3d conic = curve.Conic(in);
  const Ellipse ellipse = EllipseOf(conic);
  if (!ellipse.real || ellipse.minor_px < 3.0 || ellipse.major_px > 4.0 * in.width_px) {
    return false;
  }
  count_ = std::clamp(static_cast<int>(2.0 * std::numbers::pi * ellipse.radius_px), kMinLines, most);
  std::array<Eigen::Vector2d, Profiles::kMaxLines> points;
  EllipsePoints(conic, std::span(points).first(static_cast<std::size_t>(count_)));
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    ProfileLine& line = lines_[k];
    line.u_px = points[k].x();
    line.v_px = points[k].y();
    DistanceTo(curve, in, line.u_px, line.v_px, line.nu, line.nv);
  }
  for (int i = 0; i < count_; ++i) {
    const ProfileLine& a = lines_[static_cast<std::size_t>((i + count_ - 1) % count_)];
    const ProfileLine& b = lines_[static_cast<std::size_t>((i + 1) % count_)];
    const double turn2 = (b.nu - a.nu) * (b.nu - a.nu) + (b.nv - a.nv) * (b.nv - a.nv);
    const double way2 = (b.u_px - a.u_px) * (b.u_px - a.u_px) + (b.v_px - a.v_px) * (b.v_px - a.v_px);
    lines_[static_cast<std::size_t>(i)].curvature = std::sqrt(turn2 / std::max(way2, 1e-12));
  }
  profiles_.Read(image, in, lines_.data(), count_, true);
  at_px_.fill(0.0);
  hidden_.fill(false);
  return true;
}

// A run of outlier lines means that an object hides the outline there. The lines beside the run may cross the
// object's border too and be slightly off without being outliers. They are hidden as well, as long as their
// samples scatter more about the edge than most lines' do. To hide a fixed length would leave too little of a
// small ellipse to determine its shape.
void CurveFitter::FindHidden(double spacing_px) {
  constexpr int kRun = 3;
  constexpr double kBesidePx = 6.0;
  constexpr double kRough = 3.0;  // times the others' variance
  constexpr int kClean = 2;       // clean lines in a row that end the hidden part
  const int beside = static_cast<int>(std::ceil(kBesidePx / spacing_px));
  const auto at = [&](int i) { return static_cast<std::size_t>((i + 2 * count_) % count_); };
  const double rough = kRough * profiles_.noise() * profiles_.noise();
  const auto hide = [&](int from, int step) {
    int clean = 0;
    for (int j = 0; j < beside && clean < kClean; ++j) {
      const std::size_t k = at(from + step * j);
      const Profiles::Edge& edge = profiles_.edge(static_cast<int>(k));
      clean = edge.valid && edge.variance < rough ? clean + 1 : 0;
      hidden_[k] = hidden_[k] || clean < kClean;
    }
  };
  hidden_.fill(false);
  for (int i = 0; i < count_; ++i) {
    bool run = true;
    for (int j = 0; j < kRun; ++j) {
      run = run && weight_[at(i + j)] < 0.1;
    }
    if (!run) {
      continue;
    }
    for (int j = 0; j < kRun; ++j) {
      hidden_[at(i + j)] = true;
    }
    hide(i + kRun, 1);
    hide(i - 1, -1);
  }
}

// Computes where `curve` crosses the lines. False if too many crossings left the sampled range.
template <class Curve>
bool CurveFitter::Place(const Intrinsics& in, const Curve& curve) {
  int outside = 0;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const ProfileLine& line = lines_[k];
    at_px_[k] = DistanceAlong(curve, in, line.u_px, line.v_px, line.nu, line.nv, at_px_[k], 1);
    outside += std::fabs(at_px_[k]) < 3.0 ? 0 : 1;
  }
  return outside <= count_ / 20;
}

// Makes the least-squares rows from the measured edges. False if there are too few.
template <class Curve>
bool CurveFitter::MakeRows(const Intrinsics& in, const Curve& curve) {
  const double noise = std::max(profiles_.noise(), edge_noise_.floor);
  row_count_ = 0;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Profiles::Edge& edge = profiles_.edge(i);
    if (!edge.valid || hidden_[k]) {
      continue;
    }
    const ProfileLine& line = lines_[k];
    const CurveRow<Curve::kDim> r =
        curve.Row(in, line.u_px + edge.at_px * line.nu, line.v_px + edge.at_px * line.nv);
    const double per_px =
        1.0 / ((r.row_u.dot(curve.p) - r.rhs_u) * line.nu + (r.row_v.dot(curve.p) - r.rhs_v) * line.nv);
    // Beside the noise every edge has an error of kMinScalePx; a line without a clean step has more.
    const double variance =
        std::max(noise * noise, 0.5 * edge.variance) / edge.info + kMinScalePx * kMinScalePx;
    Row& row = rows_[row_count_++];
    for (int n = 0; n < Curve::kDim; ++n) {
      row.row[static_cast<std::size_t>(n)] = r.row[n] * per_px;
    }
    row.rhs = r.rhs * per_px;
    row.root_info = 1.0 / std::sqrt(variance);
    row.line = k;
  }
  return row_count_ >= kMinLines / 3;
}

// Computes residual_ [row_count_] in standard deviations. Returns Tukey's limit for them.
template <int kN>
double CurveFitter::Residuals(const Eigen::Matrix<double, kN, 1>& p) {
  for (std::size_t i = 0; i < row_count_; ++i) {
    double off = -rows_[i].rhs;
    for (std::size_t n = 0; n < kN; ++n) {
      off += rows_[i].row[n] * p[static_cast<Eigen::Index>(n)];
    }
    residual_[i] = off * rows_[i].root_info;
    size_[i] = std::fabs(residual_[i]);
  }
  const auto middle = size_.begin() + static_cast<std::ptrdiff_t>(row_count_ / 2);
  std::nth_element(size_.begin(), middle, size_.begin() + static_cast<std::ptrdiff_t>(row_count_));
  return BiweightLimit(*middle);
}

// One step of weighted least squares. False if the sum of weights is too small.
template <int kN>
bool CurveFitter::Solve(Eigen::Matrix<double, kN, 1>& p) {
  const double limit = Residuals<kN>(p);
  constexpr auto kSize = static_cast<std::size_t>(kN);
  std::array<double, kSize*(kSize + 1) / 2> normal{};  // its lower triangle, row by row
  std::array<double, kSize> right{};
  double weights = 0.0;
  weight_.fill(0.0);
  for (std::size_t i = 0; i < row_count_; ++i) {
    const Row& r = rows_[i];
    const double w = Biweight(residual_[i], limit);
    weight_[r.line] = w;
    weights += w;
    const double wi = w * r.root_info * r.root_info;
    std::size_t at = 0;
    for (std::size_t n = 0; n < kSize; ++n) {
      const double wr = wi * r.row[n];
      right[n] += wr * r.rhs;
      for (std::size_t m = 0; m <= n; ++m) {
        normal[at++] += wr * r.row[m];
      }
    }
  }
  Eigen::Matrix<double, kN, kN> information;
  std::size_t at = 0;
  for (Eigen::Index n = 0; n < kN; ++n) {
    for (Eigen::Index m = 0; m <= n; ++m) {
      information(n, m) = information(m, n) = normal[at++];
    }
  }
  p = information.ldlt().solve(Eigen::Map<const Eigen::Matrix<double, kN, 1>>(right.data()));
  return weights > kMinLines / 4.0 && p.allFinite();
}

// Computes the fit's covariance and quality from the edges of the last round.
template <class Curve>
bool CurveFitter::Describe(CurveFit<Curve>& fit) {
  constexpr int kN = Curve::kDim;
  using Vector = Eigen::Matrix<double, kN, 1>;
  const double noise = std::max(profiles_.noise(), edge_noise_.floor);
  const double quiet = std::min(noise, 1.5 * profiles_.quiet() + 0.5);
  const double limit = Residuals<kN>(fit.curve.p);
  Eigen::Matrix<double, kN, kN> normal = Eigen::Matrix<double, kN, kN>::Zero();
  Vector common = Vector::Zero();  // effect of an equal shift of all edges
  Vector aside_u = Vector::Zero();
  Vector aside_v = Vector::Zero();
  double chi2 = 0.0;
  double rms2 = 0.0;
  double noise2 = 0.0;
  double weights = 0.0;
  double contrast = 0.0;
  for (std::size_t i = 0; i < row_count_; ++i) {
    const Row& r = rows_[i];
    const Vector row = Eigen::Map<const Vector>(r.row.data());
    const Profiles::Edge& edge = profiles_.edge(static_cast<int>(r.line));
    const double w = Biweight(residual_[i], limit);
    const double info = r.root_info * r.root_info;
    const Vector weighted = w * info * row;
    normal += weighted * row.transpose();
    common += weighted;
    aside_u += lines_[r.line].nu * weighted;
    aside_v += lines_[r.line].nv * weighted;
    chi2 += w * residual_[i] * residual_[i];
    rms2 += w * residual_[i] * residual_[i] / info;
    noise2 += w * quiet * quiet / edge.info;
    weights += w;
    contrast += w * edge.contrast;
  }
  const Eigen::Matrix<double, kN, kN> inverse = normal.inverse();
  if (!(weights > kMinLines / 4.0) || !inverse.allFinite()) {
    return false;
  }
  // Scaled by the scatter of the edges, but at least by half the standard deviation from the samples.
  fit.cov = std::max(chi2 / std::max(weights - kN, 1.0), 0.25) * inverse;
  // Common shifts: outward, along u, along v.
  const double together_px =
      profiles_.shaded() ? std::max(kShadedPx, edge_noise_.shift_px) : edge_noise_.shift_px;
  for (const Vector& shift : {common, aside_u, aside_v}) {
    const Vector dp = inverse * (together_px * shift);
    fit.cov += dp * dp.transpose();
  }
  fit.rms_px = std::sqrt(rms2 / weights);
  fit.noise_px = std::sqrt(noise2 / weights);
  fit.contrast = contrast / weights;
  // Count the lines with an edge on the curve, including edges with little weight.
  int on_curve = 0;
  for (int i = 0; i < count_; ++i) {
    const Profiles::Edge& edge = profiles_.edge(i);
    const double off_px = edge.at_px - at_px_[static_cast<std::size_t>(i)];
    on_curve += edge.valid && std::fabs(off_px) < kOnCurvePx + 3.0 * noise / std::sqrt(edge.info) ? 1 : 0;
  }
  fit.seen = static_cast<double>(on_curve) / count_;
  return fit.cov.allFinite();
}

// Measures and fits in rounds, with at most `most` lines, until one moves the curve less than `still_px`.
template <class Curve>
bool CurveFitter::Approach(const Picture& image, const Intrinsics& in, int most, int rounds, double still_px,
                           bool shaded, CurveFit<Curve>& fit) {
  if (!ReadLines(image, in, fit.curve, most)) {
    return false;
  }
  weight_.fill(1.0);
  Ellipse last = EllipseOf(fit.curve.Conic(in));
  for (int round = 0; round < rounds; ++round) {
    if (round > 0 && !Place(in, fit.curve) && !ReadLines(image, in, fit.curve, most)) {
      return false;
    }
    if (shaded && round > 0 && last.radius_px > Profiles::kHalf && fit.blur_px < kShadedBlurPx) {
      // Shading and edge can be separated once the edge is known to less than a pixel and is not too blurred.
      profiles_.FitShading(at_px_, weight_, last.radius_px, fit.blur_px);
    }
    profiles_.Measure(at_px_, weight_, fit.blur_px);
    if (!MakeRows(in, fit.curve)) {
      return false;
    }
    // The first round repeats the weighting, because its outliers are not known yet.
    constexpr int kReweights = 3;
    for (int i = 0; i < (round == 0 ? kReweights : 1); ++i) {
      if (!Solve<Curve::kDim>(fit.curve.p)) {
        return false;
      }
    }
    const double blur = std::clamp(fit.blur_px + profiles_.blur_change_px(), kMinBlurPx, kMaxBlurPx);
    const bool sharp = std::fabs(blur - fit.blur_px) < 0.05 * blur;
    fit.blur_px = blur;
    fit.ellipse = EllipseOf(fit.curve.Conic(in));
    if (!fit.ellipse.real) {
      return false;
    }
    const double moved = std::hypot(fit.ellipse.u_px - last.u_px, fit.ellipse.v_px - last.v_px) +
                         std::fabs(fit.ellipse.radius_px - last.radius_px);
    last = fit.ellipse;
    if (most > kFewLines) {
      FindHidden(2.0 * std::numbers::pi * last.radius_px / count_);
    }
    if (sharp && moved < still_px && round > 0) {
      break;
    }
  }
  return true;
}

template <class Curve>
CurveFit<Curve> CurveFitter::Fit(const Picture& image, const Intrinsics& in, const Curve& start,
                                 bool shaded) {
  CurveFit<Curve> fit;
  fit.curve = start;
  fit.blur_px = kStartBlurPx;
  fit.converged = Approach(image, in, kFewLines, kFewRounds, kNearPx, false, fit) &&
                  Approach(image, in, Profiles::kMaxLines, kRounds, kStillPx, shaded, fit) && Describe(fit);
  return fit;
}

template CurveFit<ConeCurve> CurveFitter::Fit(const Picture&, const Intrinsics&, const ConeCurve&, bool);
template CurveFit<EllipseCurve> CurveFitter::Fit(const Picture&, const Intrinsics&, const EllipseCurve&,
                                                 bool);

}  // namespace fovea::vision
