// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vision/vision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "tools/bench/common/figure.hpp"
#include "tools/bench/vision/bound.hpp"
#include "tools/bench/vision/contestants.hpp"
#include "tools/bench/vision/picture_target.hpp"
#include "tools/bench/vision/scenes.hpp"

namespace fovea::bench {
namespace {

constexpr double kWrongPx = 2.0;  // a detection with a larger error of centre or corner is wrong
constexpr double kGoalMs = 0.5;
constexpr double kGoalTrackedMs = 0.1;

struct Score {
  int with_target = 0;
  int without = 0;
  int found = 0;  // pictures with a target, found with an error of at most kWrongPx
  int wrong = 0;  // found with a larger error, or in a picture without a target
  double centre2 = 0.0;
  double radius2 = 0.0;
  double bound_centre2 = 0.0;  // of the found targets
  double bound_radius2 = 0.0;
  double chi2 = 0.0;
  double worst_px = 0.0;
  std::vector<double> ms;
  std::vector<double> tracked_ms;
};

double Median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Function>
double MsOf(Function function) {
  const auto start = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// The truth about a picture's target, and the best possible accuracy.
struct Truth {
  TrueOutline outline;
  std::size_t corners = 0;  // of a polygon; else 0
  Bound bound;
};

void Judge(Contestant& contestant, const cv::Mat& image, const Truth* truth, Score& score) {
  Answer answer;
  score.ms.push_back(MsOf([&] { answer = contestant.Look(image); }));
  if (truth == nullptr) {
    ++score.without;
    score.wrong += answer.found ? 1 : 0;
    return;
  }
  ++score.with_target;
  if (!answer.found) {
    return;
  }
  const TrueOutline& outline = truth->outline;
  const double off_px = std::hypot(answer.u_px - outline.u_px, answer.v_px - outline.v_px);
  if (OffOf({answer.u_px, answer.v_px}, answer.corners, outline, truth->corners) > kWrongPx) {
    ++score.wrong;
    return;
  }
  ++score.found;
  score.centre2 += 0.5 * off_px * off_px;
  score.radius2 += std::pow(answer.radius_px - outline.radius_px, 2);
  score.bound_centre2 += truth->bound.centre_px * truth->bound.centre_px;
  score.bound_radius2 += truth->bound.radius_px * truth->bound.radius_px;
  score.worst_px = std::max(score.worst_px, off_px);
  score.chi2 += answer.sigma_px > 0.0 ? 0.5 * std::pow(off_px / answer.sigma_px, 2) : 0.0;
  if (contestant.tracks()) {
    score.tracked_ms.push_back(MsOf([&] { contestant.LookAgain(image); }));
  }
}

const char* NameOf(TargetKind kind) { return features::TraitsOf(kind).name; }

struct Row {
  std::string contestant;
  Score score;
};

// Runs one class of one target: all contestants on the same pictures.
void RunClass(const SceneClass& scenes, TargetKind kind, const VisionArguments& arguments,
              std::vector<Figure>& figures) {
  const PictureCamera camera;
  const auto contestants = MakeContestants(kind, camera, scenes.clutter);
  std::vector<Row> rows;
  rows.reserve(contestants.size());
  for (const auto& contestant : contestants) {
    rows.push_back({contestant->name(), {}});
  }
  for (int i = 0; i < arguments.pictures; ++i) {
    const bool with_target = i % 3 != 2;
    const auto seed = static_cast<unsigned>(arguments.seed * 100'003 + i);
    const PictureScene scene = MakeScene(scenes, kind, with_target, seed);
    const cv::Mat image = Draw(scene);
    Truth truth;
    if (with_target) {
      const Body& body = scene.bodies.front();
      truth = {OutlineOf(scene.camera, body), body.corners.size(), CramerRao(scene)};
    }
    for (std::size_t k = 0; k < contestants.size(); ++k) {
      Judge(*contestants[k], image, with_target ? &truth : nullptr, rows[k].score);
    }
  }
  const bool is_round = features::TraitsOf(kind).body != features::TargetBody::kPlate;
  if (!arguments.json) {
    fmt::print("{}, {}\n", NameOf(kind), scenes.name);
  }
  for (const Row& row : rows) {
    const Score& s = row.score;
    const double n = std::max(s.found, 1);
    const double centre = std::sqrt(s.centre2 / n);
    const double radius = std::sqrt(s.radius2 / n);
    const double bound_centre = std::sqrt(s.bound_centre2 / n);
    const double bound_radius = std::sqrt(s.bound_radius2 / n);
    std::optional<double> goal_centre;
    std::optional<double> goal_radius;
    if (is_round && row.contestant == "fovea" && scenes.goal_px > 0.0) {
      goal_centre = std::max(scenes.goal_px, 1.3 * bound_centre);
      goal_radius = std::max(scenes.goal_px, 1.3 * bound_radius);
    }
    if (!arguments.json) {
      const std::string tracked =
          s.tracked_ms.empty() ? "     -" : fmt::format("{:6.3f}", Median(s.tracked_ms));
      fmt::print("  {:<23}{:5.1f} {:5.1f} {:6.3f} {:6.3f} {:6.3f} {:6.3f} {:>6} {:6.2f} {:6.2f} {:6.2f} {}\n",
                 row.contestant, 100.0 * s.found / std::max(s.with_target, 1),
                 100.0 * s.wrong / std::max(s.with_target + s.without, 1), centre, radius, bound_centre,
                 bound_radius, goal_centre ? fmt::format("{:.3f}", *goal_centre) : "-", s.worst_px,
                 s.chi2 / n, Median(s.ms), tracked);
      std::fflush(stdout);
    }
    if (row.contestant != "fovea") {
      continue;
    }
    const std::string prefix = fmt::format("vision_{}_{}_", NameOf(kind), scenes.name);
    figures.push_back({prefix + "found", 100.0 * s.found / std::max(s.with_target, 1), "%", 100.0});
    figures.push_back({prefix + "wrong", 100.0 * s.wrong / std::max(s.with_target + s.without, 1), "%", 0.0});
    figures.push_back({prefix + "centre_rms", centre, "px", goal_centre});
    figures.push_back({prefix + "radius_rms", radius, "px", goal_radius});
    figures.push_back({prefix + "centre_bound", bound_centre, "px", std::nullopt});
    figures.push_back({prefix + "radius_bound", bound_radius, "px", std::nullopt});
    figures.push_back({prefix + "ms_p50", Median(s.ms), "ms", kGoalMs});
    figures.push_back({prefix + "tracked_ms_p50", Median(s.tracked_ms), "ms", kGoalTrackedMs});
  }
}

}  // namespace

int RunVision(const VisionArguments& arguments) {
  cv::setNumThreads(1);
  if (!arguments.json) {
    fmt::print(
        "{} pictures of 640x480 per class, a third of them without a target; rms along one axis [px]\n",
        arguments.pictures);
    fmt::print("{:<25}{:>5} {:>5} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6}\n", "target, class",
               "found", "wrong", "centre", "radius", "CR c.", "CR r.", "goal", "worst", "chi2/2", "ms",
               "track");
    fmt::print("{:<25}{:>5} {:>5}\n", "", "%", "%");
    // In the columns of the figures below.
    fmt::print("{:<25}{:5.1f} {:5.1f} {:>55.2f} {:6.3f}\n", "goals for round targets", 100.0, 0.0, kGoalMs,
               kGoalTrackedMs);
  }
  std::vector<Figure> figures;
  bool any = false;
  for (const features::TargetTraits& target : features::kTargets) {
    const TargetKind kind = target.kind;
    if (arguments.target != "all" && arguments.target != NameOf(kind)) {
      continue;
    }
    for (const SceneClass& scenes : SceneClasses()) {
      const bool fits = !scenes.off_axis || target.body == features::TargetBody::kBall;
      if (fits && (arguments.only.empty() || arguments.only == scenes.name)) {
        RunClass(scenes, kind, arguments, figures);
        any = true;
      }
    }
  }
  if (!any) {
    throw config::InputError(
        fmt::format("--class {}: --target {} has no such class", arguments.only, arguments.target));
  }
  if (arguments.json) {
    fmt::print("{}\n", ToJson(figures));
  }
  return config::kDone;
}

}  // namespace fovea::bench
