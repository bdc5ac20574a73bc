#include "tools/bench/tick/feature_speed.hpp"

#include <fmt/format.h>

#include <random>
#include <stdexcept>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/features/triangle.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tools/bench/common/spread.hpp"

namespace fovea::bench {
namespace {

using features::FeatureForm;
using hal::FeatureKind;

constexpr int kPlaces = 500;
constexpr int kRounds = 41;

struct Listed {
  FeatureKind target;
  FeatureForm form;
};
constexpr Listed kListed[] = {
    {FeatureKind::kSphere, FeatureForm::kSphere},    {FeatureKind::kSphere, FeatureForm::kCircle},
    {FeatureKind::kCircle, FeatureForm::kCircle},    {FeatureKind::kSquare, FeatureForm::kCorners},
    {FeatureKind::kSquare, FeatureForm::kSide},      {FeatureKind::kSquare, FeatureForm::kCornerSide},
    {FeatureKind::kSquare, FeatureForm::kPose},      {FeatureKind::kTriangle, FeatureForm::kPose},
    {FeatureKind::kTriangle, FeatureForm::kCorners},
};

// 0.35 to 0.65 m off, in the picture, tilted and turned by some 10 degrees.
std::vector<features::TargetInCamera> RandomPlaces() {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<features::TargetInCamera> places(kPlaces);
  for (features::TargetInCamera& place : places) {
    place.X_CO.p = {0.1 * unit(engine), 0.1 * unit(engine), 0.5 + 0.15 * unit(engine)};
    place.X_CO.R = model::RotationOf(0.2 * model::Vec3(unit(engine), unit(engine), unit(engine)));
    place.v_BO_C = 0.1 * model::Vec3(unit(engine), unit(engine), unit(engine));
  }
  return places;
}

features::TargetFeature MakeFeature(const Listed& listed) {
  features::TargetFeature feature;
  feature.target = listed.target;
  feature.form = listed.form;
  feature.corners = listed.target == FeatureKind::kTriangle
                        ? features::MakeTriangle(features::kDefaultTriangle)
                        : features::MakeSquare(feature.side);
  return feature;
}

double ComputeNs(const features::TargetFeature& feature,
                 const std::vector<features::TargetInCamera>& places) {
  features::FeatureState state;
  int refused = 0;
  const double ns = MedianNs(kRounds, places, [&](const features::TargetInCamera& place) {
    refused += feature.Compute(place, state) ? 0 : 1;
  });
  if (refused > 0) {
    throw std::logic_error("a feature refuses a place that it is timed at");
  }
  return ns;
}

}  // namespace

std::vector<Figure> FeatureSpeed() {
  const std::vector<features::TargetInCamera> places = RandomPlaces();
  std::vector<Figure> figures;
  for (const Listed& listed : kListed) {
    const features::TargetFeature feature = MakeFeature(listed);
    if (!feature.IsListed()) {
      throw std::logic_error("a feature that is timed is not listed");
    }
    const std::string name =
        fmt::format("interaction_{}_{}_ns", features::kTargetNames[static_cast<std::size_t>(listed.target)],
                    features::kFormNames[static_cast<std::size_t>(listed.form)]);
    figures.push_back({name, ComputeNs(feature, places), "ns", {}});
  }
  return figures;
}

}  // namespace fovea::bench
