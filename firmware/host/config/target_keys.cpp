#include "firmware/host/config/target_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {
namespace {

constexpr double kDifferent = 0.05;  // sides differ by this share of the longest, at least
constexpr double kFlat = 0.1;        // the height over the longest side is this share of it, at least

void CheckTriangle(const features::Polygon& triangle) {
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
  const auto* kind = std::find(features::kTargetNames.begin(), features::kTargetNames.end(), s.kind);
  feature.target = static_cast<hal::FeatureKind>(kind - features::kTargetNames.begin());
  feature.radius = 0.5 * s.diameter;
  feature.side = s.side;
  feature.form = features::TraitsOf(feature.target).form;
  if (feature.target == hal::FeatureKind::kSquare) {
    feature.corners = features::MakeSquare(s.side);
  } else if (feature.target == hal::FeatureKind::kTriangle) {
    std::array<double, 6> corners{};
    std::copy(s.triangle.begin(), s.triangle.end(), corners.begin());
    feature.corners = features::MakeTriangle(corners);
    CheckTriangle(feature.corners);
  }
  return feature;
}

}  // namespace fovea::config
