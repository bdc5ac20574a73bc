// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/find/curve_finder.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <numbers>

namespace fovea::vision {
namespace {

// Lengths are in pixels of the reduced image.
constexpr double kPieceRms = 0.42;    // a piece with a larger rms distance from its curve is cut
constexpr double kNear = 0.75;        // points nearer than this support a curve
constexpr double kAlongNormal = 0.8;  // least cosine between a supporter's gradient and the curve's normal
constexpr double kPointSigma = 0.3;
constexpr double kDirectionSigma = 0.12;  // of a gradient's direction [rad]
constexpr std::size_t kShortestPiece = 7;
constexpr int kMostCuts = 8;
constexpr std::size_t kCornerPoints = 2;  // dropped on each side of a cut, because the corner rounds them
constexpr double kLeastTurn = 0.9;        // a piece that turns less does not determine its curve [rad]
constexpr int kClosest = 2;               // smallest reduction factor
constexpr double kLeastArc = 0.25;        // each piece of a pair must turn this much [rad]
constexpr double kMostArc = 4.0;
constexpr std::size_t kMostCandidates = 24;
constexpr int kSectors = 48;

// Total turn of the gradient along the piece [rad].
double Turn(std::span<const EdgePoint> piece) {
  double turn = 0.0;
  constexpr std::size_t kStep = 3;
  for (std::size_t i = kStep; i < piece.size(); i += kStep) {
    const EdgePoint& a = piece[i - kStep];
    const EdgePoint& b = piece[i];
    turn += std::atan2(static_cast<double>(a.gu * b.gv - a.gv * b.gu),
                       static_cast<double>(a.gu * b.gu + a.gv * b.gv));
  }
  return std::fabs(turn);
}

// Index of the piece's sharpest turn; its middle if there is none.
std::size_t SharpestTurn(std::span<const EdgePoint> piece) {
  constexpr std::size_t kReach = 3;
  std::size_t best = piece.size() / 2;
  float lowest = 0.8F;
  // Skip the ends, where the corner of the last cut still shows.
  for (std::size_t i = 2 * kReach; i + 2 * kReach < piece.size(); ++i) {
    const EdgePoint& a = piece[i - kReach];
    const EdgePoint& b = piece[i + kReach];
    const float same = a.gu * b.gu + a.gv * b.gv;
    if (same < lowest) {
      lowest = same;
      best = i;
    }
  }
  return best;
}

}  // namespace

template <class Curve>
bool CurveFinder<Curve>::IsAllowed(const Ellipse& e) const {
  // Loose limits: the reduced image is accurate to a pixel or two, and the fit checks the size again.
  return e.real && e.radius_px >= 0.8 * limits_.radius_min_px && e.radius_px <= limits_.radius_max_px &&
         e.minor_px >= limits_.aspect_min * e.major_px && e.u_px > -e.radius_px && e.v_px > -e.radius_px &&
         e.u_px < in_->width_px + e.radius_px && e.v_px < in_->height_px + e.radius_px;
}

// Least squares of the points' distances and of their gradients' directions.
template <class Curve>
typename CurveFinder<Curve>::Fitted CurveFinder<Curve>::FitPoints(std::span<const EdgePoint> points) const {
  constexpr int kN = Curve::kDim;
  using Vector = Eigen::Matrix<double, kN, 1>;
  using Matrix = Eigen::Matrix<double, kN, kN>;
  Fitted fit;
  double mean_u = 0.0;
  double mean_v = 0.0;
  for (const EdgePoint& p : points) {
    mean_u += static_cast<double>(p.u_px);
    mean_v += static_cast<double>(p.v_px);
  }
  const auto n = static_cast<double>(points.size());
  mean_u /= n;
  mean_v /= n;
  double spread = 0.0;
  // Centre the curve's frame where the lines along the gradients meet, for a well-conditioned fit.
  double a11 = 1e-9, a12 = 0.0, a22 = 1e-9, b1 = 0.0, b2 = 0.0;
  for (const EdgePoint& p : points) {
    const double du = static_cast<double>(p.u_px) - mean_u;
    const double dv = static_cast<double>(p.v_px) - mean_v;
    spread += du * du + dv * dv;
    const auto gu = static_cast<double>(p.gu);
    const auto gv = static_cast<double>(p.gv);
    const double along = gv * du - gu * dv;
    a11 += gv * gv;
    a12 -= gv * gu;
    a22 += gu * gu;
    b1 += gv * along;
    b2 -= gu * along;
  }
  const double det = a11 * a22 - a12 * a12;
  double u0 = mean_u;
  double v0 = mean_v;
  double size = std::sqrt(spread / n);
  if (det > 1e-4 * n * n) {
    const double du = (a22 * b1 - a12 * b2) / det;
    const double dv = (a11 * b2 - a12 * b1) / det;
    if (std::hypot(du, dv) < 4.0 * size) {
      u0 += du;
      v0 += dv;
      double sum = 0.0;
      for (const EdgePoint& p : points) {
        const double du_p = static_cast<double>(p.u_px) - u0;
        const double dv_p = static_cast<double>(p.v_px) - v0;
        sum += std::sqrt(du_p * du_p + dv_p * dv_p);
      }
      size = sum / n;
    }
  }
  fit.curve.Frame(*in_, u0, v0, std::max(size, 1.0));
  const double scale = map_->factor();
  for (int round = 0; round < 2; ++round) {
    Matrix normal = Matrix::Identity() * 1e-12;
    Vector right = Vector::Zero();
    for (const EdgePoint& p : points) {
      const auto gu = static_cast<double>(p.gu);
      const auto gv = static_cast<double>(p.gv);
      const CurveRow<kN> r = fit.curve.Row(*in_, static_cast<double>(p.u_px), static_cast<double>(p.v_px));
      double length = 1.0;
      if (round > 0) {
        const double slope_u = r.row_u.dot(fit.curve.p) - r.rhs_u;
        const double slope_v = r.row_v.dot(fit.curve.p) - r.rhs_v;
        length = std::sqrt(slope_u * slope_u + slope_v * slope_v);
      } else if constexpr (kN == EllipseCurve::kDim) {
        length = 2.0 / size;  // gradient of a circle
      } else {
        length = size / (in_->f_u_px * in_->f_u_px);  // gradient of a small cone
      }
      const double wd = 1.0 / (length * kPointSigma * scale);
      normal += wd * wd * r.row * r.row.transpose();
      right += wd * wd * r.rhs * r.row;
      const Vector cross = r.row_u * gv - r.row_v * gu;
      const double wc = 1.0 / (length * kDirectionSigma);
      normal += wc * wc * cross * cross.transpose();
      right += wc * wc * (r.rhs_u * gv - r.rhs_v * gu) * cross;
    }
    fit.curve.p = normal.ldlt().solve(right);
    if (!fit.curve.p.allFinite()) {
      return fit;
    }
  }
  double sum = 0.0;
  for (const EdgePoint& p : points) {
    double nu = 0.0;
    double nv = 0.0;
    const double d =
        DistanceTo(fit.curve, *in_, static_cast<double>(p.u_px), static_cast<double>(p.v_px), nu, nv);
    sum += d * d;
  }
  fit.rms_px = std::sqrt(sum / n);
  fit.ok = std::isfinite(fit.rms_px);
  return fit;
}

template <class Curve>
void CurveFinder<Curve>::TryPiece(std::span<const EdgePoint> piece, int depth) {
  if (piece.size() < kShortestPiece || candidates_.size() >= kMostCandidates) {
    return;
  }
  if (Turn(piece) >= kLeastTurn) {
    const Fitted fit = FitPoints(piece);
    if (fit.ok && fit.rms_px < kPieceRms * map_->factor()) {
      if (IsAllowed(EllipseOf(fit.curve.Conic(*in_)))) {
        Offer(fit.curve);
      }
      return;
    }
  }
  Remember(piece);
  if (depth == 0) {
    return;
  }
  const std::size_t cut = SharpestTurn(piece);
  TryPiece(piece.first(cut - std::min(cut, kCornerPoints)), depth - 1);
  TryPiece(piece.subspan(std::min(cut + kCornerPoints, piece.size())), depth - 1);
}

// Keeps the longest pieces that turn, but no part of a piece that is kept already.
template <class Curve>
void CurveFinder<Curve>::Remember(std::span<const EdgePoint> piece) {
  const double turn = Turn(piece);
  if (turn < kLeastArc || turn > kMostArc || SharpestTurn(piece) != piece.size() / 2) {
    return;
  }
  const auto holds = [&](std::span<const EdgePoint> other) {
    return other.data() <= piece.data() && piece.data() < other.data() + other.size();
  };
  const auto kept = std::span(arcs_).first(arc_count_);
  if (std::any_of(kept.begin(), kept.end(), holds)) {
    return;
  }
  if (arc_count_ < arcs_.size()) {
    arcs_[arc_count_++] = piece;
    return;
  }
  auto shortest = std::min_element(kept.begin(), kept.end(),
                                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (shortest->size() < piece.size()) {
    *shortest = piece;
  }
}

// If an object hides part of the target, the remaining pieces of the outline may each be too short to
// determine the curve. Two pieces together can determine it.
template <class Curve>
void CurveFinder<Curve>::TryPairs() {
  for (std::size_t i = 0; i < arc_count_; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      pair_.assign(arcs_[i].begin(), arcs_[i].end());
      pair_.insert(pair_.end(), arcs_[j].begin(), arcs_[j].end());
      const Fitted fit = FitPoints(pair_);
      if (fit.ok && fit.rms_px < kPieceRms * map_->factor() && IsAllowed(EllipseOf(fit.curve.Conic(*in_)))) {
        Offer(fit.curve);
      }
    }
  }
}

// Collects the points on the curve in supporters_ and sets `seen`. False if there are too few.
template <class Curve>
bool CurveFinder<Curve>::Gather(CurveCandidate<Curve>& candidate) {
  const Ellipse& e = candidate.ellipse;
  const double near = kNear * map_->factor();
  const double reach = e.major_px + 2.0 * near;
  std::bitset<kSectors> covered;
  supporters_.clear();
  for (const EdgePoint& p : map_->points()) {
    const double du = static_cast<double>(p.u_px) - e.u_px;
    const double dv = static_cast<double>(p.v_px) - e.v_px;
    if (std::fabs(du) > reach || std::fabs(dv) > reach) {
      continue;
    }
    double nu = 0.0;
    double nv = 0.0;
    const double d =
        DistanceTo(candidate.curve, *in_, static_cast<double>(p.u_px), static_cast<double>(p.v_px), nu, nv);
    if (!(std::fabs(d) < near) ||
        std::fabs(nu * static_cast<double>(p.gu) + nv * static_cast<double>(p.gv)) < kAlongNormal) {
      continue;
    }
    supporters_.push_back(p);
    const double turn = std::atan2(dv, du) / (2.0 * std::numbers::pi) + 0.5;
    // A point covers the sectors that a pixel of the reduced image spans.
    const int wide =
        static_cast<int>(0.5 * kSectors * map_->factor() / (2.0 * std::numbers::pi * e.radius_px));
    for (int k = -wide; k <= wide; ++k) {
      const int sector = static_cast<int>(turn * kSectors) + k + kSectors;
      covered.set(static_cast<std::size_t>(sector % kSectors));
    }
  }
  candidate.seen = static_cast<double>(covered.count()) / kSectors;
  return supporters_.size() >= kShortestPiece;
}

template <class Curve>
void CurveFinder<Curve>::Offer(const Curve& curve) {
  CurveCandidate<Curve> candidate{curve, EllipseOf(curve.Conic(*in_)), 0.0};
  const auto is_known = [&](const Ellipse& e) {
    return std::any_of(candidates_.begin(), candidates_.end(), [&](const auto& other) {
      const double close = 0.08 * e.radius_px + 1.5;
      return std::hypot(other.ellipse.u_px - e.u_px, other.ellipse.v_px - e.v_px) < close &&
             std::fabs(other.ellipse.radius_px - e.radius_px) < close;
    });
  };
  constexpr int kGatherings = 2;
  for (int i = 0; i < kGatherings; ++i) {
    if (is_known(candidate.ellipse) || !Gather(candidate)) {
      return;
    }
    const Fitted fit = FitPoints(supporters_);
    const Ellipse e = EllipseOf(fit.curve.Conic(*in_));
    if (!fit.ok || !IsAllowed(e)) {
      return;
    }
    candidate.curve = fit.curve;
    candidate.ellipse = e;
  }
  if (!is_known(candidate.ellipse) && Gather(candidate) && candidate.seen >= limits_.seen_min) {
    candidates_.push_back(candidate);
  }
}

template <class Curve>
const std::vector<CurveCandidate<Curve>>& CurveFinder<Curve>::Find(const EdgeMap& map, const Intrinsics& in,
                                                                   const RoundLimits& limits) {
  map_ = &map;
  in_ = &in;
  limits_ = limits;
  candidates_.clear();
  arc_count_ = 0;
  for (int i = 0; i < map.chain_count(); ++i) {
    TryPiece(map.Chain(i), kMostCuts);
  }
  // The last resort, only at the smallest reduction.
  if (candidates_.empty() && map.factor() == kClosest) {
    TryPairs();
  }
  std::sort(candidates_.begin(), candidates_.end(),
            [](const auto& a, const auto& b) { return a.seen > b.seen; });
  return candidates_;
}

template class CurveFinder<ConeCurve>;
template class CurveFinder<EllipseCurve>;

}  // namespace fovea::vision
