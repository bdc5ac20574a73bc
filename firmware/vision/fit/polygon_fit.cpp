// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/fit/polygon_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "firmware/vision/fit/biweight.hpp"

namespace fovea::vision {
namespace {

constexpr int kSideRounds = 6;
constexpr double kCornerPx = 4.0;      // lines keep this distance from a corner, which rounds edges
constexpr double kRoundedBlurs = 4.5;  // edges nearer than this may still be rounded [blur_px]
constexpr double kStraight = 0.95;     // share of a side's edges on its line, above which no part is hidden
constexpr int kMinSideLines = 6;       // on a side
// Shift and turn of a side that is partly hidden: the covering object is next to the rest.
constexpr double kPartShiftPx = 0.04;

}  // namespace

// Places lines across the sides and judges the colours beside them. False if a side's length is impossible.
bool PolygonFitter::PlaceLines(const Picture& image, const Intrinsics& in, const PolygonFit& fit) {
  const int n = fit.corners.count;
  std::array<int, Detection::kMaxCorners> ends{};
  count_ = 0;
  for (int k = 0; k < n; ++k) {
    const ImagePoint& p = fit.corners.corner[static_cast<std::size_t>(k)];
    const ImagePoint& q = fit.corners.corner[static_cast<std::size_t>((k + 1) % n)];
    Side& side = sides_[static_cast<std::size_t>(k)];
    const double du = q.u_px - p.u_px;
    const double dv = q.v_px - p.v_px;
    side.length = std::hypot(du, dv);
    if (!(side.length > 8.0) || side.length > 4.0 * in.width_px) {
      return false;
    }
    side.nu = dv / side.length;
    side.nv = -du / side.length;
    side.from = count_;
    side.line = SideLine{};
    const double skip = std::min(kCornerPx, 0.2 * side.length);
    const int lines =
        std::clamp(static_cast<int>(side.length - 2.0 * skip), kMinSideLines, Profiles::kMaxLines / n);
    for (int i = 0; i < lines; ++i) {
      const double way = skip + (side.length - 2.0 * skip) * i / (lines - 1);
      const auto line = static_cast<std::size_t>(count_++);
      lines_[line] = {p.u_px + way / side.length * du, p.v_px + way / side.length * dv, side.nu, side.nv,
                      0.0};
      place_[line] = 2.0 * way / side.length - 1.0;
    }
    side.to = count_;
    ends[static_cast<std::size_t>(k)] = count_;
  }
  const auto corners = static_cast<std::size_t>(n);
  evidence_.Look(image, in, std::span(fit.corners.corner).first(corners),
                 std::span(lines_).first(static_cast<std::size_t>(count_)), std::span(ends).first(corners));
  return true;
}

bool PolygonFitter::ReadLines(const Picture& image, const Intrinsics& in, const PolygonFit& fit) {
  if (!PlaceLines(image, in, fit)) {
    return false;
  }
  profiles_.Read(image, in, lines_.data(), count_, false);
  at_px_.fill(0.0);
  return true;
}

bool PolygonFitter::FitSide(Side& side, double blur, PolygonFit& fit, double& rms2, double& noise2,
                            double& weights) {
  const double noise = std::max(profiles_.noise(), edge_noise_.floor);
  const double quiet = std::min(noise, 1.5 * profiles_.quiet() + 0.5);
  const double straight = 1.0 - 2.0 * kRoundedBlurs * blur / side.length;
  std::size_t count = 0;
  int clear = 0;
  for (int i = side.from; i < side.to; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Profiles::Edge& edge = profiles_.edge(i);
    weight_[k] = 0.0;
    off_[k] = false;
    if (!evidence_.clear(i)) {
      continue;
    }
    ++clear;
    if (edge.valid) {
      edge_line_[count] = i;
      edges_[count++] = {place_[k], edge.at_px, noise * noise / edge.info + kMinScalePx * kMinScalePx,
                         std::fabs(place_[k]) > straight};
    }
  }
  const int beside =
      static_cast<int>(std::ceil(SideEvidence::kBesidePx * (side.to - side.from) / side.length));
  if (!FitSideLine(std::span(edges_).first(count), beside, side.line)) {
    return false;
  }
  for (std::size_t j = 0; j < count; ++j) {
    const SideEdge& e = edges_[j];
    const Profiles::Edge& edge = profiles_.edge(edge_line_[j]);
    const double off = e.at_px - side.line.a - side.line.b * e.t;
    weight_[static_cast<std::size_t>(edge_line_[j])] = e.weight;
    off_[static_cast<std::size_t>(edge_line_[j])] = e.off;
    rms2 += e.weight * off * off;
    noise2 += e.weight * quiet * quiet / edge.info;
    weights += e.weight;
    fit.contrast += e.weight * edge.contrast;
    fit.seen += e.weight > 0.2 ? 1.0 : 0.0;
  }
  fit.least_on = std::min(fit.least_on, side.line.on * static_cast<double>(count) / std::max(clear, 1));
  // Add the shift by lens and light, and the turn of the seen part about its middle.
  const Eigen::Vector2d turned(-side.line.middle, 1.0);
  const bool part = clear < side.to - side.from || side.line.on < kStraight;
  const double common = part ? std::max(kPartShiftPx, edge_noise_.shift_px) : edge_noise_.shift_px;
  side.line.cov(0, 0) += common * common;
  side.line.cov +=
      common * common / (3.0 * side.line.spread * side.line.spread) * turned * turned.transpose();
  return true;
}

// Moves the corners to the intersections of the sides and computes their covariance.
void PolygonFitter::MoveCorners(PolygonFit& fit) const {
  const int n = fit.corners.count;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, CornerFit::kMaxSize,
                                 CornerFit::kMaxSize>;
  Jacobian J = Jacobian::Zero(2 * n, 2 * n);  // derivative of the corners by the sides' a, b
  Jacobian cov = Jacobian::Zero(2 * n, 2 * n);
  for (int k = 0; k < n; ++k) {
    const int before = (k + n - 1) % n;
    const Side& s = sides_[static_cast<std::size_t>(before)];  // ends here, t = 1
    const Side& e = sides_[static_cast<std::size_t>(k)];       // begins here, t = -1
    Eigen::Matrix2d normals;
    normals << s.nu, s.nv, e.nu, e.nv;
    const Eigen::Matrix2d inverse = normals.inverse();
    const Eigen::Vector2d move = inverse * Eigen::Vector2d(s.line.a + s.line.b, e.line.a - e.line.b);
    ImagePoint& corner = fit.corners.corner[static_cast<std::size_t>(k)];
    corner.u_px += move.x();
    corner.v_px += move.y();
    J.block<2, 1>(2 * k, 2 * before) += inverse.col(0);
    J.block<2, 1>(2 * k, 2 * before + 1) += inverse.col(0);
    J.block<2, 1>(2 * k, 2 * k) += inverse.col(1);
    J.block<2, 1>(2 * k, 2 * k + 1) -= inverse.col(1);
    cov.block<2, 2>(2 * k, 2 * k) = e.line.cov;
  }
  fit.corners.cov = J * cov * J.transpose();
  fit.corners.cov.diagonal().array() += edge_noise_.corner_px * edge_noise_.corner_px;
}

// Measures and fits in rounds until the sides stop moving.
bool PolygonFitter::Approach(const Picture& image, const Intrinsics& in, double& blur, PolygonFit& fit) {
  for (int round = 0; round < kSideRounds; ++round) {
    profiles_.Measure(at_px_, weight_, blur);
    double rms2 = 0.0;
    double noise2 = 0.0;
    double weights = 0.0;
    fit.contrast = 0.0;
    fit.seen = 0.0;
    fit.least_on = 1.0;
    double moved = 0.0;
    double read = 0.0;
    for (int k = 0; k < fit.corners.count; ++k) {
      Side& side = sides_[static_cast<std::size_t>(k)];
      if (!FitSide(side, blur, fit, rms2, noise2, weights)) {
        return false;
      }
      for (int i = side.from; i < side.to; ++i) {
        const auto line = static_cast<std::size_t>(i);
        const double now = side.line.a + side.line.b * place_[line];
        moved = std::max(moved, std::fabs(now - at_px_[line]));
        read = std::max(read, std::fabs(now));
        at_px_[line] = now;
      }
    }
    fit.rms_px = std::sqrt(rms2 / std::max(weights, 1e-9));
    fit.noise_px = std::sqrt(noise2 / std::max(weights, 1e-9));
    fit.contrast /= std::max(weights, 1e-9);
    fit.quiet = profiles_.quiet();
    fit.seen /= count_;
    const double next = std::clamp(blur + profiles_.blur_change_px(), kMinBlurPx, kMaxBlurPx);
    const bool still = round >= 3 && std::fabs(next - blur) < 0.05 * blur && moved < kStillPx;
    blur = next;
    const bool last = still || round == kSideRounds - 1;
    if (last || read > 3.0) {
      MoveCorners(fit);
      if (last) {
        break;
      }
      if (!ReadLines(image, in, fit)) {
        return false;
      }
    }
  }
  for (const ImagePoint& p :
       std::span(fit.corners.corner).first(static_cast<std::size_t>(fit.corners.count))) {
    if (!std::isfinite(p.u_px) || !std::isfinite(p.v_px)) {
      return false;
    }
  }
  return true;
}

// Whether no part is hidden, judged by the present lines.
bool PolygonFitter::IsWhole(const PolygonFit& fit) const {
  return evidence_.is_whole() && fit.least_on > kStraight;
}

PolygonFit PolygonFitter::Fit(const Picture& image, const Intrinsics& in, std::span<const ImagePoint> start) {
  PolygonFit fit;
  fit.corners.count = static_cast<int>(start.size());
  std::copy(start.begin(), start.end(), fit.corners.corner.begin());
  double blur = kStartBlurPx;
  // A second pass if a part is hidden: the hidden part is only located well once the sides are known.
  for (int pass = 0; pass < 2; ++pass) {
    weight_.fill(1.0);
    if (!ReadLines(image, in, fit) || !Approach(image, in, blur, fit)) {
      return fit;
    }
    if (IsWhole(fit)) {
      break;
    }
  }
  // Before lines are placed again, because off_ belongs to the present ones: a side that is one pixel longer
  // can have more lines.
  fit.bends_explained = evidence_.ExplainsBends(off_);
  if (!PlaceLines(image, in, fit)) {
    return fit;
  }
  fit.least_seen = 1.0;
  for (int k = 0; k < fit.corners.count; ++k) {
    fit.least_seen = std::min(fit.least_seen, evidence_.side(k).seen);
  }
  fit.whole = IsWhole(fit);
  fit.against = evidence_.against();
  fit.corners_hidden = evidence_.CornersHidden();
  fit.converged =
      fit.corners.cov.allFinite() && RadiusOf(std::span(fit.corners.corner).first(start.size())) > 0.0;
  return fit;
}

}  // namespace fovea::vision
