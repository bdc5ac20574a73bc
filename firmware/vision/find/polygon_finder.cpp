// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/find/polygon_finder.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numbers>

namespace fovea::vision {
namespace {

// In pixels of the reduced image.
constexpr double kStraight = 0.75;  // largest distance of a straight piece's points from its line
constexpr double kNearSide = 0.9;   // points nearer than this support a side
constexpr double kOverlap = 3.0;    // how far pieces may extend beyond the corner between them
constexpr double kShortest = 3.5;   // shortest piece

constexpr double kMinTurn = 0.30;   // least sine of the angle between neighbouring sides,
constexpr double kMinSharp = 0.12;  // and at an acute corner: a triangle that is seen obliquely has some
constexpr std::size_t kMostSegments = 28;
constexpr std::size_t kMostPolygons = 24;
constexpr int kMostSideCuts = 7;           // of one side that is tried
constexpr int kSideBins = 24;              // along a side, to see which part of it has edge points
constexpr double kAlongSideNormal = 0.85;  // cosine between an edge point's gradient and the side's normal
constexpr double kGap = 3.0;               // missing length of a side, at most, in lengths of its seen part

}  // namespace

double RadiusOf(std::span<const ImagePoint> corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const ImagePoint& a = corners[i];
    const ImagePoint& b = corners[(i + 1) % corners.size()];
    twice += a.u_px * b.v_px - b.u_px * a.v_px;
  }
  const double radius = std::sqrt(0.5 * std::fabs(twice) / std::numbers::pi);
  return twice < 0.0 ? -radius : radius;
}

// Cuts `piece` into straight pieces at the point furthest from the line between its ends.
void PolygonFinder::Cut(std::span<const EdgePoint> piece, int depth) {
  const double scale = map_->factor();
  if (piece.size() < 4) {
    return;
  }
  const auto u = [&](std::size_t i) { return static_cast<double>(piece[i].u_px); };
  const auto v = [&](std::size_t i) { return static_cast<double>(piece[i].v_px); };
  const std::size_t end = piece.size() - 1;
  const double du = u(end) - u(0);
  const double dv = v(end) - v(0);
  const double length = std::hypot(du, dv);
  std::size_t furthest = 0;
  double distance = -1.0;
  for (std::size_t i = 1; i < end; ++i) {
    const double d = length > 2.0 * scale
                         ? std::fabs(du * (v(i) - v(0)) - dv * (u(i) - u(0))) / length
                         : std::hypot(u(i) - u(0), v(i) - v(0));  // the chain ends where it began
    if (d > distance) {
      distance = d;
      furthest = i;
    }
  }
  if (distance > kStraight * scale) {
    if (depth > 0) {
      Cut(piece.first(furthest + 1), depth - 1);
      Cut(piece.subspan(furthest), depth - 1);
    }
    return;
  }
  // Fit a line; a long piece without its ends, which a corner may have rounded.
  const std::size_t skip = piece.size() > 12 ? 2 : piece.size() > 7 ? 1 : 0;
  double mu = 0.0, mv = 0.0, uu = 0.0, uv = 0.0, vv = 0.0;
  const auto n = static_cast<double>(piece.size() - 2 * skip);
  for (std::size_t i = skip; i <= end - skip; ++i) {
    mu += u(i) / n;
    mv += v(i) / n;
  }
  for (std::size_t i = skip; i <= end - skip; ++i) {
    uu += (u(i) - mu) * (u(i) - mu);
    uv += (u(i) - mu) * (v(i) - mv);
    vv += (v(i) - mv) * (v(i) - mv);
  }
  const double angle = 0.5 * std::atan2(2.0 * uv, uu - vv);
  Segment s;
  s.du = std::cos(angle);
  s.dv = std::sin(angle);
  if (s.du * du + s.dv * dv < 0.0) {
    s.du = -s.du;
    s.dv = -s.dv;
  }
  const double t0 = (u(0) - mu) * s.du + (v(0) - mv) * s.dv;
  const double t1 = (u(end) - mu) * s.du + (v(end) - mv) * s.dv;
  s.length = t1 - t0;
  if (s.length < kShortest * scale) {
    return;
  }
  s.u0 = mu + t0 * s.du;
  s.v0 = mv + t0 * s.dv;
  s.u1 = mu + t1 * s.du;
  s.v1 = mv + t1 * s.dv;
  segments_.push_back(s);
}

// Whether b can be the side after a, in a polygon whose inside is on the left (sign -1) or right (+1).
bool PolygonFinder::Follows(const Segment& a, const Segment& b, double sign, ImagePoint& corner) const {
  const double cross = a.du * b.dv - a.dv * b.du;
  const bool is_acute = a.du * b.du + a.dv * b.dv < 0.0;
  if (sign * cross < (is_acute ? kMinSharp : kMinTurn)) {
    return false;
  }
  const double ru = b.u0 - a.u1;
  const double rv = b.v0 - a.v1;
  // The corner is at a's end + beyond * a's direction = b's start + before * b's direction.
  const double beyond = (ru * b.dv - rv * b.du) / cross;
  const double before = (a.dv * ru - a.du * rv) / cross;
  const double overlap = kOverlap * map_->factor();
  if (beyond < -overlap || beyond > kGap * a.length + overlap || before > overlap ||
      before < -(kGap * b.length + overlap)) {
    return false;
  }
  corner = {a.u1 + beyond * a.du, a.v1 + beyond * a.dv};
  return true;
}

void PolygonFinder::Extend(int depth, double sign) {
  const auto at = [&](int i) -> const Segment& {
    return segments_[static_cast<std::size_t>(chosen_[static_cast<std::size_t>(i)])];
  };
  if (depth == corners_) {
    if (Follows(at(corners_ - 1), at(0), sign, corner_[0])) {
      Offer(sign);
    }
    return;
  }
  for (int next = chosen_[0] + 1; next < static_cast<int>(segments_.size()); ++next) {
    if (std::find(chosen_.begin(), chosen_.begin() + depth, next) != chosen_.begin() + depth) {
      continue;
    }
    if (Follows(at(depth - 1), segments_[static_cast<std::size_t>(next)], sign,
                corner_[static_cast<std::size_t>(depth)])) {
      chosen_[static_cast<std::size_t>(depth)] = next;
      Extend(depth + 1, sign);
    }
  }
}

// Adds the chosen polygon to the candidates if it is allowed. corner_[i] is where side i begins.
void PolygonFinder::Offer(double sign) {
  PolygonCandidate candidate;
  candidate.count = corners_;
  for (int i = 0; i < corners_; ++i) {
    const int from = sign > 0.0 ? i : corners_ - 1 - i;
    candidate.corner[static_cast<std::size_t>(i)] = corner_[static_cast<std::size_t>(from)];
  }
  const std::span corners(candidate.corner.data(), static_cast<std::size_t>(corners_));
  const double radius = RadiusOf(corners);
  if (radius < limits_.radius_min_px || radius > limits_.radius_max_px) {
    return;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const ImagePoint& a = corners[i];
    const ImagePoint& b = corners[(i + 1) % corners.size()];
    if (std::hypot(b.u_px - a.u_px, b.v_px - a.v_px) < limits_.side_min_px) {
      return;
    }
  }
  candidate.seen = Seen(candidate);
  if (candidate.seen < limits_.seen_min) {
    return;
  }
  const double close = 0.1 * radius + 2.0;
  for (PolygonCandidate& other : candidates_) {
    // The same polygon from other pieces of its sides: the corners match after a cyclic shift.
    for (int turn = 0; turn < corners_; ++turn) {
      bool same = true;
      for (int i = 0; i < corners_; ++i) {
        const ImagePoint& a = candidate.corner[static_cast<std::size_t>(i)];
        const ImagePoint& b = other.corner[static_cast<std::size_t>((i + turn) % corners_)];
        same = same && std::hypot(a.u_px - b.u_px, a.v_px - b.v_px) < close;
      }
      if (same) {
        if (candidate.seen > other.seen) {
          other = candidate;
        }
        return;
      }
    }
  }
  if (candidates_.size() < kMostPolygons) {
    candidates_.push_back(candidate);
  }
}

// The share of the outline that lies on edges.
double PolygonFinder::Seen(const PolygonCandidate& polygon) const {
  const double near = kNearSide * map_->factor();
  double seen = 0.0;
  double whole = 0.0;
  for (int i = 0; i < polygon.count; ++i) {
    const ImagePoint& a = polygon.corner[static_cast<std::size_t>(i)];
    const ImagePoint& b = polygon.corner[static_cast<std::size_t>((i + 1) % polygon.count)];
    const double length = std::hypot(b.u_px - a.u_px, b.v_px - a.v_px);
    const double du = (b.u_px - a.u_px) / length;
    const double dv = (b.v_px - a.v_px) / length;
    std::bitset<kSideBins> covered;
    for (const EdgePoint& p : map_->points()) {
      const double ru = static_cast<double>(p.u_px) - a.u_px;
      const double rv = static_cast<double>(p.v_px) - a.v_px;
      const double t = ru * du + rv * dv;
      if (std::fabs(du * rv - dv * ru) > near || t < 0.0 || t >= length ||
          std::fabs(static_cast<double>(p.gv) * du - static_cast<double>(p.gu) * dv) < kAlongSideNormal) {
        continue;
      }
      const int wide = static_cast<int>(0.7 * kSideBins * map_->factor() / length);
      const int bin = static_cast<int>(t / length * kSideBins);
      for (int k = std::max(0, bin - wide); k <= std::min(kSideBins - 1, bin + wide); ++k) {
        covered.set(static_cast<std::size_t>(k));
      }
    }
    seen += length * static_cast<double>(covered.count()) / kSideBins;
    whole += length;
  }
  return whole > 0.0 ? seen / whole : 0.0;
}

const std::vector<PolygonCandidate>& PolygonFinder::Find(const EdgeMap& map, int corners,
                                                         const PolygonLimits& limits) {
  map_ = &map;
  corners_ = corners;
  limits_ = limits;
  segments_.clear();
  candidates_.clear();
  for (int i = 0; i < map.chain_count(); ++i) {
    Cut(map.Chain(i), kMostSideCuts);
  }
  std::sort(segments_.begin(), segments_.end(),
            [](const Segment& a, const Segment& b) { return a.length > b.length; });
  segments_.resize(std::min(segments_.size(), kMostSegments));
  for (const double sign : {-1.0, 1.0}) {
    for (int first = 0; first < static_cast<int>(segments_.size()); ++first) {
      chosen_[0] = first;
      Extend(1, sign);
    }
  }
  std::sort(candidates_.begin(), candidates_.end(),
            [](const PolygonCandidate& a, const PolygonCandidate& b) { return a.seen > b.seen; });
  return candidates_;
}

}  // namespace fovea::vision
