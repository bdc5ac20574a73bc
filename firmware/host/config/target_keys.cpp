// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/target_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {
namespace {

using features::Polygon;

constexpr double kDifferent = 0.05;  // least difference of two sides, as a share of the longest
constexpr double kFlat = 0.1;        // least height over the longest side, as a share of that side

void CheckTriangle(const Polygon& triangle) {
  const auto& c = triangle.corners;
  std::array<double, 3> sides{(c[0] - c[1]).norm(), (c[1] - c[2]).norm(), (c[2] - c[0]).norm()};
  std::sort(sides.begin(), sides.end());
  const double longest = sides[2];
  const double height = model::Cross(c[1] - c[0], c[2] - c[0]).norm() / std::max(longest, 1e-12);
  if (!(longest >= 0.005 && height >= kFlat * longest)) {
    throw InputError(fmt::format(
        "target.triangle: its longest side is {:.3g} m and its height over it {:.3g} m; the side must be at "
        "least 0.005 m and the height at least {:g} of the side",
        longest, height, kFlat));
  }
  if (std::min(sides[1] - sides[0], sides[2] - sides[1]) < kDifferent * longest) {
    throw InputError(fmt::format(
        "target.triangle: sides of {:.3g}, {:.3g} and {:.3g} m are too similar to tell its corners apart; "
        "they must differ by at least {:g} of the longest",
        sides[0], sides[1], sides[2], kDifferent));
  }
}

Polygon SquareOf(const TargetSettings& s) { return features::MakeSquare(s.side); }

Polygon TriangleOf(const TargetSettings& s) {
  std::array<double, 6> corners{};
  std::copy(s.triangle.begin(), s.triangle.end(), corners.begin());
  const Polygon triangle = features::MakeTriangle(corners);
  CheckTriangle(triangle);
  return triangle;
}

// The corners of each plate, from its keys; null for what is round. In the order of features::kTargets.
using MakeCorners = Polygon (*)(const TargetSettings& settings);
constexpr std::array<MakeCorners, features::kTargets.size()> kCorners{nullptr, nullptr, SquareOf, TriangleOf};
static_assert([] {
  for (std::size_t i = 0; i < kCorners.size(); ++i) {
    if ((kCorners[i] != nullptr) != (features::kTargets[i].body == features::TargetBody::kPlate)) {
      return false;
    }
  }
  return true;
}());

}  // namespace

void AddTargetKeys(TargetSettings& s, KeyTable& keys) {
  keys.Choice("target.kind", s.kind, {features::kTargetNames.begin(), features::kTargetNames.end()},
              "kind of the target");
  keys.Number("target.diameter", s.diameter, 0.005, 2.0, "m", "diameter of a sphere or a circle");
  keys.Number("target.side", s.side, 0.005, 2.0, "m", "side of a square");
  keys.Numbers(
      "target.triangle", s.triangle, 6, 6, -1.0, 1.0, "m",
      "a triangle's corners, x right and y down of each, centred on their mean; its three sides must differ");
}

features::TargetFeature MakeTarget(const TargetSettings& s) {
  features::TargetFeature feature;
  const features::TargetTraits& traits = *features::FindTraits(s.kind);
  feature.target = traits.kind;
  feature.radius = 0.5 * s.diameter;
  feature.side = s.side;
  feature.form = traits.form;
  if (const MakeCorners make = kCorners[static_cast<std::size_t>(traits.kind)]; make != nullptr) {
    feature.corners = make(s);
  }
  return feature;
}

}  // namespace fovea::config
