// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/features/tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "firmware/host/config/program.hpp"
#include "firmware/host/config/target_keys.hpp"
#include "tools/fovea/features/extraction.hpp"
#include "tools/fovea/features/study.hpp"

namespace fovea {
namespace {

using features::FeatureForm;
using features::TargetFeature;
using hal::FeatureKind;
using Json = nlohmann::ordered_json;

constexpr int kPerClass = 3;  // pictures of the set, for each target

struct TableRow {
  const char* name;
  TargetFeature feature;
  model::Vec3 p_OC;  // position of the camera
  const char* note;
};

std::vector<TableRow> TableRows() {
  const auto make = [](FeatureKind kind, FeatureForm form, bool hold) {
    config::TargetSettings settings;
    settings.kind = features::kTargetNames[static_cast<std::size_t>(kind)];
    TargetFeature feature = config::MakeTarget(settings);
    feature.form = form;
    feature.hold_orientation = hold;
    return feature;
  };
  const double r = 0.06;
  const double c = r * std::sqrt(0.75);
  TargetFeature equilateral = make(FeatureKind::kTriangle, FeatureForm::kCorners, false);
  equilateral.corners = features::MakeTriangle({0.0, -r, c, 0.5 * r, -c, 0.5 * r});
  const model::Vec3 above(0.0, 0.0, -0.4);
  const model::Vec3 aside(0.12, 0.08, -0.38);
  return {
      {"circle", make(FeatureKind::kCircle, FeatureForm::kCircle, false), aside, "all tilts look alike"},
      {"sphere", make(FeatureKind::kSphere, FeatureForm::kSphere, false), aside,
       "orientation is not observable"},
      {"sphere, turn held", make(FeatureKind::kSphere, FeatureForm::kSphere, true), aside, "stacked"},
      {"square, source's", make(FeatureKind::kSquare, FeatureForm::kSide, false), aside,
       "underconstrained: 4 of 6"},
      {"square, corners", make(FeatureKind::kSquare, FeatureForm::kCorners, false), aside, "8 entries for 6"},
      {"triangle", make(FeatureKind::kTriangle, FeatureForm::kCorners, false), aside,
       "up to four poses look alike"},
      {"  from above", make(FeatureKind::kTriangle, FeatureForm::kCorners, false), above, ""},
      {"  equilateral", equilateral, aside, "also full rank, although its three turns look alike"},
      {"  on its cylinder", equilateral, {0.0, -r, -0.4}, "camera above a corner: loses rank"},
      {"triangle, pose", make(FeatureKind::kTriangle, FeatureForm::kPose, false), aside,
       "a single goal pose"},
  };
}

std::string ScatterText(const Scatter& scatter) {
  return scatter.found < Scatter::kPictures ? fmt::format("{}/{} seen", scatter.found, Scatter::kPictures)
                                            : fmt::format("{:.3g}", 1e6 * scatter.worst);
}

}  // namespace

int PrintFeatureTables(bool json) {
  cv::setNumThreads(1);
  std::array<Search, features::kTargetNames.size()> searches;
  for (std::size_t i = 0; i < searches.size(); ++i) {
    searches[i] = MeasureSearch(static_cast<FeatureKind>(i), kPerClass);
  }
  Json list = Json::array();
  if (!json) {
    fmt::print("  {:<18} {:<34} {:>6} {:>5} {:>9} {:>6} {:>6} {:>8}\n    free motions, notes\n", "target",
               "s", "L_s", "rank", "condition", "found", "ms", "scatter");
  }
  for (const TableRow& row : TableRows()) {
    const model::Pose X_CO = LookFrom(row.p_OC);
    const FeatureStudy study = Study(row.feature, X_CO);
    const Scatter scatter = MeasureScatter(row.feature, X_CO);
    const Search& search = searches[static_cast<std::size_t>(row.feature.target)];
    std::vector<std::string> free;
    for (const FreeTwist& twist : study.free) {
      free.push_back(twist.words.substr(0, twist.words.find(':')));
    }
    const auto dim = static_cast<int>(study.state.s.size());
    if (json) {
      Json entry;
      entry["target"] = row.name;
      entry["parameters"] = Parameters(row.feature);
      entry["dim"] = dim;
      entry["rank"] = study.rank;
      entry["condition"] = std::isfinite(study.condition) ? Json(study.condition) : Json(nullptr);
      entry["controls"] = study.controls;
      entry["free"] = free;
      entry["found"] = search.found;
      entry["ms"] = search.ms;
      entry["scatter_found"] = scatter.found;
      entry["scatter_per_level"] = scatter.per_level;
      entry["scatter_of_range"] = scatter.worst;
      entry["note"] = row.note;
      list.push_back(entry);
      continue;
    }
    fmt::print("  {:<18} {:<34} {:>6} {:>5} {:>9} {:>4.0f} % {:>6.2f} {:>8}\n", row.name,
               Parameters(row.feature), fmt::format("{}x6", dim), study.rank, ConditionText(study.condition),
               100.0 * search.found, search.ms, ScatterText(scatter));
    const std::string notes =
        fmt::format("{}{}{}", fmt::join(free, "; "), free.empty() || *row.note == '\0' ? "" : "; ", row.note);
    if (!notes.empty()) {
      config::PrintFitted("    " + notes, 4);
    }
  }
  if (json) {
    fmt::print("{}\n", list.dump(2));
    return config::kDone;
  }
  fmt::print(
      "  found, ms: search without a hint in {} pictures of each target, with noise, blur, low contrast,\n"
      "  occlusion, off the axis. scatter: standard deviation of the worst entry of s per gray level of\n"
      "  noise, in millionths of its range over the poses of these pictures; from {} pictures at this pose,\n"
      "  contrast {} gray levels\n",
      8 * kPerClass, Scatter::kPictures, Scatter::kContrast);
  return config::kDone;
}

}  // namespace fovea
