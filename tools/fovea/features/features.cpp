// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/features/features.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "tools/fovea/features/study.hpp"
#include "tools/fovea/features/tables.hpp"

namespace fovea {
namespace {

using features::FeatureForm;
using features::TargetFeature;
using hal::FeatureKind;
using Json = nlohmann::ordered_json;

// "x,y,z,qw,qx,qy,qz"
model::Pose ParsePose(const char* flag, const std::string& text) {
  std::array<double, 7> v{};
  std::istringstream stream(text);
  std::size_t count = 0;
  std::string word;
  bool sound = true;
  while (std::getline(stream, word, ',')) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    sound = sound && !word.empty() && *end == '\0' && std::isfinite(value) && count < v.size();
    if (sound) {
      v[count++] = value;
    }
  }
  model::Pose X_CO;
  X_CO.p = {v[0], v[1], v[2]};
  if (!sound || count != v.size() || !model::RotationOfQuaternion({v[3], v[4], v[5], v[6]}, X_CO.R)) {
    throw config::InputError(fmt::format(
        "{} {}: must be seven numbers x,y,z,qw,qx,qy,qz: the target's pose in the camera [m]", flag, text));
  }
  return X_CO;
}

const char* NameOf(FeatureKind kind) { return features::kTargetNames[static_cast<std::size_t>(kind)]; }
const char* NameOf(FeatureForm form) { return features::kFormNames[static_cast<std::size_t>(form)]; }

TargetFeature MakeFeature(const FeaturesArguments& arguments) {
  TargetFeature feature = config::MakeTarget(arguments.target);
  if (arguments.feature != "auto") {
    const auto* form = std::find(features::kFormNames.begin(), features::kFormNames.end(), arguments.feature);
    feature.form = static_cast<FeatureForm>(form - features::kFormNames.begin());
  }
  feature.hold_orientation = arguments.hold_orientation;
  const model::Pose goal = ParsePose("--goal", arguments.goal);
  feature.p_CO_C_star = goal.p;
  feature.R_CO_star = goal.R;
  if (!feature.IsListed()) {
    throw config::InputError(
        fmt::format("--feature {}{}: not a feature of a {}, or too many entries in total", arguments.feature,
                    arguments.hold_orientation ? " --hold-orientation" : "", NameOf(feature.target)));
  }
  return feature;
}

std::vector<std::vector<double>> Rows(const features::InteractionMatrix& L) {
  std::vector<std::vector<double>> rows;
  for (Eigen::Index i = 0; i < L.rows(); ++i) {
    rows.emplace_back();
    for (Eigen::Index j = 0; j < 6; ++j) {
      rows.back().push_back(L(i, j));
    }
  }
  return rows;
}

Json Finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

int PrintStudy(const FeaturesArguments& arguments) {
  const TargetFeature feature = MakeFeature(arguments);
  const FeatureStudy study = Study(feature, ParsePose("--pose", arguments.pose));
  if (study.refused) {
    throw config::InputError(
        fmt::format("--pose {}: target and goal must be completely in front of the camera and not edge-on",
                    arguments.pose));
  }
  std::vector<double> s(study.state.s.begin(), study.state.s.end());
  // With a focal length, image coordinates are printed in pixels too.
  std::vector<double> s_px;
  const bool in_image = feature.form != FeatureForm::kSphere && features::IsInImage(feature.form);
  for (std::size_t i = 0; arguments.focal_px > 0.0 && in_image && i < s.size(); ++i) {
    const bool is_angle =
        i == 2 && (feature.form == FeatureForm::kSide || feature.form == FeatureForm::kCornerSide);
    s_px.push_back(is_angle ? s[i] : arguments.focal_px * s[i]);
  }
  if (arguments.json) {
    Json json;
    json["target"] = NameOf(feature.target);
    json["feature"] = NameOf(feature.form);
    json["parameters"] = Parameters(feature);
    json["dim"] = s.size();
    json["s"] = s;
    if (!s_px.empty()) {
      json["s_px"] = s_px;
    }
    json["s_star"] = std::vector<double>(study.state.s_star.begin(), study.state.s_star.end());
    json["L_s"] = Rows(study.state.L_s);
    json["singular_values"] = study.sigma;
    json["rank"] = study.rank;
    json["condition"] = Finite(study.condition);
    json["controls"] = study.controls;
    json["free"] = Json::array();
    json["free_twists"] = Json::array();
    for (const FreeTwist& free : study.free) {
      json["free"].push_back(free.words);
      json["free_twists"].push_back(std::vector<double>(free.V_BC_C.begin(), free.V_BC_C.end()));
    }
    fmt::print("{}\n", json.dump(2));
    return config::kDone;
  }
  fmt::print("  {:<14}{}, by {}: {}\n", "target", NameOf(feature.target), NameOf(feature.form),
             Parameters(feature));
  fmt::print("  {:<14}{:.6g}\n", "s", fmt::join(s, "  "));
  if (!s_px.empty()) {
    fmt::print("  {:<14}{:.6g}  (f = {:g} px)\n", "in pixels", fmt::join(s_px, "  "), arguments.focal_px);
  }
  const char* head = "L_s";
  for (const std::vector<double>& row : Rows(study.state.L_s)) {
    fmt::print("  {:<14}{:>10.4f}\n", head, fmt::join(row, " "));
    head = "";
  }
  fmt::print("  {:<14}{} of 6, condition {}, singular values {:.4g}\n", "rank", study.rank,
             ConditionText(study.condition), fmt::join(study.sigma, " "));
  fmt::print(
      "  {:<14}{}\n", "controls",
      study.controls.empty() ? "no motion by itself" : fmt::format("{}", fmt::join(study.controls, ", ")));
  for (const FreeTwist& free : study.free) {
    fmt::print("  {:<14}{}\n", "free", free.words);
  }
  return config::kDone;
}

// The condition number over camera positions above the target, at the pose's distance, looking at it.
int PrintSweep(const FeaturesArguments& arguments) {
  constexpr int kColumns = 61;
  constexpr int kRows = 31;
  const TargetFeature feature = MakeFeature(arguments);
  const double height = ParsePose("--pose", arguments.pose).p.norm();
  const auto at = [&](int i, int count) { return arguments.span * (2.0 * i / (count - 1) - 1.0); };
  std::vector<std::vector<double>> condition;
  for (int row = 0; row < kRows; ++row) {
    condition.emplace_back();
    for (int column = 0; column < kColumns; ++column) {
      const FeatureStudy study = Study(feature, LookFrom({at(column, kColumns), at(row, kRows), -height}));
      condition.back().push_back(study.refused ? std::numeric_limits<double>::quiet_NaN() : study.condition);
    }
  }
  if (arguments.json) {
    Json json;
    json["target"] = NameOf(feature.target);
    json["feature"] = NameOf(feature.form);
    json["height"] = height;
    json["span"] = arguments.span;
    json["condition"] = Json::array();
    for (const std::vector<double>& row : condition) {
      json["condition"].push_back(Json::array());
      for (const double value : row) {
        json["condition"].back().push_back(Finite(value));
      }
    }
    fmt::print("{}\n", json.dump());
    return config::kDone;
  }
  // One character per half power of ten.
  constexpr std::string_view kSigns = " .:-=+*#%@";
  fmt::print(
      "  condition of L_s, {} by {}, camera {:g} m above the target, up to {:g} m sideways, looking at it\n",
      NameOf(feature.target), NameOf(feature.form), height, arguments.span);
  for (const std::vector<double>& row : condition) {
    std::string line;
    for (const double value : row) {
      const double step = std::isfinite(value) ? 2.0 * std::log10(value) : 1e9;
      line += std::isnan(value)
                  ? '?'
                  : kSigns[static_cast<std::size_t>(std::clamp(step, 0.0, kSigns.size() - 1.0))];
    }
    fmt::print("  |{}|\n", line);
  }
  fmt::print("  one character per half power of ten: \"{}\" from 1 to {:.0f} and above\n", kSigns,
             std::pow(10.0, 0.5 * (kSigns.size() - 1.0)));
  return config::kDone;
}

}  // namespace

CLI::App* AddFeatures(CLI::App& app, FeaturesArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "features", "analyse a target's image feature: s, L_s, rank, condition number, unobservable motions");
  std::vector<std::string> forms(features::kFormNames.begin(), features::kFormNames.end());
  forms.emplace_back("auto");
  command
      ->add_option("--target", arguments.target.kind,
                   fmt::format("{}", fmt::join(features::kTargetNames, ", ")))
      ->check(CLI::IsMember(
          std::vector<std::string>(features::kTargetNames.begin(), features::kTargetNames.end())))
      ->capture_default_str();
  command->add_option("--feature", arguments.feature, "as servo.feature; auto: the target's default feature")
      ->check(CLI::IsMember(forms))
      ->capture_default_str();
  command->add_flag("--hold-orientation", arguments.hold_orientation,
                    "also hold the orientation (stacked below the feature)");
  command->add_option("--pose", arguments.pose, "X_CO as x,y,z,qw,qx,qy,qz [m]")->capture_default_str();
  command->add_option("--goal", arguments.goal, "X_CO at the goal")->capture_default_str();
  command->add_option("--diameter", arguments.target.diameter, "diameter of a sphere or circle [m]")
      ->check(CLI::Range(0.005, 2.0))
      ->capture_default_str();
  command->add_option("--side", arguments.target.side, "side of a square [m]")
      ->check(CLI::Range(0.005, 2.0))
      ->capture_default_str();
  command->add_option("--triangle", arguments.target.triangle, "corners x1,y1,x2,y2,x3,y3 [m]")
      ->delimiter(',')
      ->expected(6);
  command->add_option("--focal", arguments.focal_px, "focal length [px], to print s in pixels too")
      ->check(CLI::Range(0.0, 1e6));
  command->add_flag("--tables", arguments.tables,
                    "print the tables of all targets: computed and measured on images");
  command->add_flag("--sweep", arguments.sweep, "plot the condition number over camera positions");
  command->add_option("--span", arguments.span, "half width of the sweep [m]")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  command->add_flag("--json", arguments.json, "print JSON");
  command->footer(
      "Examples:\n"
      "  fovea features --target sphere --pose 0.05,0,0.4,1,0,0,0\n"
      "  fovea features --target square --feature side --focal 554.3\n"
      "  fovea features --target triangle --feature corners --sweep\n"
      "  fovea features --tables\n"
      "Exit: 0 done, 2 wrong usage or input.");
  return command;
}

int Features(const FeaturesArguments& arguments) {
  if (arguments.tables) {
    return PrintFeatureTables(arguments.json);
  }
  return arguments.sweep ? PrintSweep(arguments) : PrintStudy(arguments);
}

}  // namespace fovea
