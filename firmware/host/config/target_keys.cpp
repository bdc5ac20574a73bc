#include "firmware/host/config/target_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {
namespace {

using features::Polygon;

constexpr double kDifferent = 0.05;  // sides differ by this share of the longest, at least
constexpr double kFlat = 0.1;        // the height over the longest side is this share of it, at least

void CheckTriangle(const Polygon& triangle) {
  const auto& c = triangle.corners;
  std::array<double, 3> sides{(c[0] - c[1]).norm(), (c[1] - c[2]).norm(), (c[2] - c[0]).norm()};
  std::sort(sides.begin(), sides.end());
  const double longest = sides[2];
  const double height = model::Cross(c[1] - c[0], c[2] - c[0]).norm() / std::max(longest, 1e-12);
  if (!(longest >= 0.005 && height >= kFlat * longest)) {
    throw InputError(fmt::format(
        "target.triangle: its longest side is {:.3g} m and its height over it {:.3g} m; allowed is a side of "
        "at least 0.005 m and a height of at least {:g} of it",
        longest, height, kFlat));
  }
  if (std::min(sides[1] - sides[0], sides[2] - sides[1]) < kDifferent * longest) {
    throw InputError(fmt::format(
        "target.triangle: sides of {:.3g}, {:.3g} and {:.3g} m are too much alike to tell its corners apart; "
        "they must differ by {:g} of the longest",
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
              "what is looked at");
  keys.Number("target.diameter", s.diameter, 0.005, 2.0, "m", "of a sphere or a circle");
  keys.Number("target.side", s.side, 0.005, 2.0, "m", "of a square");
  keys.Numbers(
      "target.triangle", s.triangle, 6, 6, -1.0, 1.0, "m",
      "the triangle's corners, x right and y down of each; put about their mean; three different sides");
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
