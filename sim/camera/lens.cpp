// SPDX-License-Identifier: Apache-2.0
#include "sim/camera/lens.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace fovea::sim {
namespace {

constexpr double kFiner = 2.0;  // pixels of the wide picture per pixel of the sensor, along each axis
constexpr int kWidestPx = 8192;
constexpr double kMarginPx = 2.0;  // of the wide picture, for the neighbours of its outermost points

Eigen::Matrix2d Slope(const Lens& l, const Eigen::Vector2d& xy) {
  const double x = xy.x();
  const double y = xy.y();
  const double r2 = xy.squaredNorm();
  const double radial = 1.0 + r2 * (l.k1 + r2 * (l.k2 + r2 * l.k3));
  const double d_radial =
      2.0 * (l.k1 + r2 * (2.0 * l.k2 + r2 * 3.0 * l.k3));  // times x (y): derivative by x (y)
  Eigen::Matrix2d slope;
  slope(0, 0) = radial + d_radial * x * x + 2.0 * l.p1 * y + 6.0 * l.p2 * x;
  slope(0, 1) = d_radial * x * y + 2.0 * l.p1 * x + 2.0 * l.p2 * y;
  slope(1, 0) = d_radial * x * y + 2.0 * l.p1 * x + 2.0 * l.p2 * y;
  slope(1, 1) = radial + d_radial * y * y + 6.0 * l.p1 * y + 2.0 * l.p2 * x;
  return slope;
}

}  // namespace

Eigen::Vector2d Distort(const Lens& l, const Eigen::Vector2d& xy) {
  const double x = xy.x();
  const double y = xy.y();
  const double r2 = xy.squaredNorm();
  const double radial = 1.0 + r2 * (l.k1 + r2 * (l.k2 + r2 * l.k3));
  return {x * radial + 2.0 * l.p1 * x * y + l.p2 * (r2 + 2.0 * x * x),
          y * radial + l.p1 * (r2 + 2.0 * y * y) + 2.0 * l.p2 * x * y};
}

namespace {

// Whether the lens keeps the picture's order at a point; behind a fold it does not.
bool KeepsOrder(const Eigen::Matrix2d& slope) { return slope.determinant() > 0.0 && slope.trace() > 0.0; }

// Moves `point` to where the lens draws `goal`, by Newton's method, until the rest is at most `enough` or no
// round changes it. False if there is no such point nearby, or only one behind a fold.
bool Approach(const Lens& lens, const Eigen::Vector2d& goal, double enough, Eigen::Vector2d& point) {
  constexpr int kRounds = 12;
  Eigen::Vector2d rest = goal - Distort(lens, point);
  for (int round = 0; round < kRounds && rest.norm() > enough; ++round) {
    const Eigen::Matrix2d slope = Slope(lens, point);
    if (!KeepsOrder(slope)) {
      return false;
    }
    const Eigen::Vector2d before = point;
    point += slope.inverse() * rest;
    if (point == before) {
      break;
    }
    rest = goal - Distort(lens, point);
  }
  return rest.norm() < std::max(enough, 1e-9) && KeepsOrder(Slope(lens, point));
}

}  // namespace

bool Undistort(const Lens& lens, const Eigen::Vector2d& xy, Eigen::Vector2d& ideal) {
  constexpr int kSteps = 8;           // from the centre outwards, so that the search cannot jump over a fold
  constexpr double kOnTheWay = 1e-6;  // a step starts the next one; only the last must be exact
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  for (int step = 1; step <= kSteps; ++step) {
    if (!Approach(lens, xy * step / kSteps, step < kSteps ? kOnTheWay : 0.0, point)) {
      return false;
    }
  }
  ideal = point;
  return true;
}

LensMap::LensMap(const Lens& lens, const Pinhole& pinhole)
    : width_(static_cast<std::size_t>(pinhole.width_px)) {
  const std::size_t width = width_;
  const auto height = static_cast<std::size_t>(pinhole.height_px);
  std::vector<Eigen::Vector2d> ideal(width * height * kPoints);
  Eigen::Vector2d reach = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < ideal.size(); ++i) {
    const std::size_t pixel = i / kPoints;
    const std::size_t column = pixel % width;
    const std::size_t row = pixel / width;
    const double u = static_cast<double>(column) + (i % 2 == 0 ? -0.25 : 0.25);
    const double v = static_cast<double>(row) + (i % kPoints < 2 ? -0.25 : 0.25);
    const Eigen::Vector2d xy((u - pinhole.c_u_px) / pinhole.f_px, (v - pinhole.c_v_px) / pinhole.FocalV());
    const bool first = i % (width * kPoints) == 0;
    ideal[i] =
        first ? Eigen::Vector2d::Zero() : ideal[i - 1];  // along a row, the next point is near the last one
    if (!(first ? Undistort(lens, xy, ideal[i]) : Approach(lens, xy, 0.0, ideal[i]))) {
      throw std::invalid_argument("the lens folds the picture before its edge");
    }
    reach = reach.cwiseMax(ideal[i].cwiseAbs());
  }
  // Centred on the optical axis: the renderer's visibility test needs that.
  const Eigen::Vector2d half = (kFiner * pinhole.f_px * reach).array().ceil() + kMarginPx;
  if (!(half.maxCoeff() * 2.0 < kWidestPx)) {
    throw std::invalid_argument("the lens has a field of view too wide to be drawn");
  }
  wide_.width_px = 2 * static_cast<int>(half.x());
  wide_.height_px = 2 * static_cast<int>(half.y());
  wide_.f_px = kFiner * pinhole.f_px;
  wide_.c_u_px = 0.5 * (wide_.width_px - 1);
  wide_.c_v_px = 0.5 * (wide_.height_px - 1);
  places_.reserve(ideal.size());
  for (const Eigen::Vector2d& xy : ideal) {
    const double u = wide_.f_px * xy.x() + wide_.c_u_px;
    const double v = wide_.f_px * xy.y() + wide_.c_v_px;
    const double left = std::floor(u);
    const double top = std::floor(v);
    const auto share = [](double part) {
      return static_cast<std::uint8_t>(std::min(255.0, std::round(256.0 * part)));
    };
    places_.push_back({static_cast<std::int32_t>(top) * wide_.width_px + static_cast<std::int32_t>(left),
                       share(u - left), share(v - top)});
  }
}

std::pair<int, int> LensMap::WideRows(int begin, int end) const {
  int first = wide_.height_px;
  int last = 0;
  for (std::size_t i = PlaceOfRow(begin); i < PlaceOfRow(end); ++i) {
    const int row = places_[i].top_left / wide_.width_px;
    first = std::min(first, row);
    last = std::max(last, row + 1);  // of the pixels below
  }
  return {first, last + 1};
}

void LensMap::Apply(std::span<const std::uint8_t> from, std::span<std::uint8_t> to) const {
  ApplyRows(0, static_cast<int>(to.size() / 4 / width_), from, to);
}

void LensMap::ApplyRows(int begin, int end, std::span<const std::uint8_t> from,
                        std::span<std::uint8_t> to) const {
  const std::size_t row = 4 * static_cast<std::size_t>(wide_.width_px);
  constexpr unsigned kWhole = 256 * 256 * kPoints;
  for (std::size_t pixel = PlaceOfRow(begin) / kPoints; pixel < PlaceOfRow(end) / kPoints; ++pixel) {
    std::array<unsigned, 4> sum{};
    for (std::size_t i = kPoints * pixel; i < kPoints * (pixel + 1); ++i) {
      const Place& place = places_[i];
      const std::uint8_t* top = from.data() + 4 * static_cast<std::size_t>(place.top_left);
      const std::uint8_t* bottom = top + row;
      const unsigned right = place.right;
      const unsigned left = 256U - right;
      const unsigned down = place.down;
      const unsigned up = 256U - down;
      for (std::size_t c = 0; c < 4; ++c) {
        sum[c] +=
            up * (left * top[c] + right * top[c + 4]) + down * (left * bottom[c] + right * bottom[c + 4]);
      }
    }
    for (std::size_t c = 0; c < 4; ++c) {
      to[4 * pixel + c] = static_cast<std::uint8_t>((sum[c] + kWhole / 2) / kWhole);
    }
  }
}

}  // namespace fovea::sim
