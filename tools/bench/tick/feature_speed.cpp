// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tick/feature_speed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/config/target_keys.hpp"
#include "tools/bench/common/spread.hpp"

namespace fovea::bench {
namespace {

constexpr int kPlaces = 500;
constexpr int kRounds = 41;

// 0.35 to 0.65 m from the camera, in the picture, tilted and turned by about 10 degrees.
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

// Each target with each of its features.
std::vector<features::TargetFeature> AllFeatures() {
  std::vector<features::TargetFeature> all;
  for (const features::TargetTraits& target : features::kTargets) {
    config::TargetSettings settings;
    settings.kind = target.name;
    features::TargetFeature feature = config::MakeTarget(settings);
    for (auto form = target.forms.begin(); form != target.forms.end(); ++form) {
      if (std::find(target.forms.begin(), form, *form) == form) {  // unused entries repeat a form
        feature.form = *form;
        all.push_back(feature);
      }
    }
  }
  return all;
}

double ComputeNs(const features::TargetFeature& feature,
                 const std::vector<features::TargetInCamera>& places) {
  features::FeatureState state;
  int refused = 0;
  const double ns = MedianNs(kRounds, places, [&](const features::TargetInCamera& place) {
    refused += feature.Compute(place, state) ? 0 : 1;
  });
  if (refused > 0) {
    throw std::logic_error("a feature refuses a pose that it is timed at");
  }
  return ns;
}

}  // namespace

std::vector<Figure> FeatureSpeed() {
  const std::vector<features::TargetInCamera> places = RandomPlaces();
  std::vector<Figure> figures;
  for (const features::TargetFeature& feature : AllFeatures()) {
    if (!feature.IsListed()) {
      throw std::logic_error("a feature that is timed is not listed");
    }
    const std::string name = fmt::format("interaction_{}_{}_ns", features::TraitsOf(feature.target).name,
                                         features::kFormNames[static_cast<std::size_t>(feature.form)]);
    figures.push_back({name, ComputeNs(feature, places), "ns", {}});
  }
  return figures;
}

}  // namespace fovea::bench
