// SPDX-License-Identifier: Apache-2.0
// Prints how methods of kinematic resolution compare in closed loop (resolve_loop.hpp), on the same starts:
//   resolve_compare [starts] [seconds per run]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/core/control/resolve_loop.hpp"

namespace fovea::control {
namespace {

using namespace resolve_loop;  // NOLINT: a program of one file
using Clock = std::chrono::steady_clock;

struct Way {
  std::string name;
  Resolve resolve;
};

std::vector<Way> Ways(const config::ServoConfig& config) {
  constexpr double kUnbounded = 1e6;
  const NullSpaceConfig pull = PostureOnly(config, kUnbounded);
  const NullSpaceConfig posture = PostureOnly(config, NullSpaceConfig{}.speed_max);
  const NullSpaceConfig all = AllWishes(config);
  const auto constrained = [](double progress_weight, bool acceleration, const NullSpaceConfig& wishes) {
    ConstrainedConfig way;
    way.progress_weight = progress_weight;
    return [=](const Scene& s) { return ByConstrained(s, wishes, way, acceleration); };
  };
  return {
      {"fixed damping", ByFixedDamping},
      {"damped, unbounded posture", [=](const Scene& s) { return ByDamped(s, pull); }},
      {"damped", [=](const Scene& s) { return ByDamped(s, posture); }},
      {"damped, all wishes", [=](const Scene& s) { return ByDamped(s, all); }},
      {"constr., unb. posture, acc.", constrained(0.3, true, pull)},
      {"constrained, acceleration", constrained(0.3, true, posture)},
      {"constrained, progress 0.1", constrained(0.1, false, posture)},
      {"constrained, progress 0.3", constrained(0.3, false, posture)},
      {"constrained, progress 1", constrained(1.0, false, posture)},
      {"constrained, all wishes", constrained(0.3, false, all)},
  };
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void Compare(int starts, double limit_s) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(540);
  std::vector<Start> samples;
  samples.reserve(static_cast<std::size_t>(starts));
  for (int k = 0; k < starts; ++k) {
    samples.push_back(Sample(random, config));
  }
  std::printf("%d starts, at most %.0f s each; path: its length in the image over the straight length\n",
              starts, limit_s);
  std::printf("%-28s %9s %8s %8s %8s %8s %8s %9s %8s %8s %8s\n", "way", "converged", "t50 s", "t95 s",
              "max |dq|", "path50", "path95", "unseen", "max |p|", "range", "ns");
  for (const Way& way : Ways(config)) {
    int converged = 0;
    int unseen = 0;
    double dq = 0.0, radius = 0.0, range = 0.0;
    std::vector<double> settle, path;
    std::chrono::nanoseconds spent{0};
    std::int64_t calls = 0;
    const Resolve timed = [&](const Scene& scene) {
      const auto before = Clock::now();
      model::VecN result = way.resolve(scene);
      spent += Clock::now() - before;
      ++calls;
      return result;
    };
    std::string failed;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Run run = Loop(config, samples[k], timed, limit_s);
      converged += run.converged ? 1 : 0;
      unseen += run.out_of_view_s > 0.0 ? 1 : 0;
      dq = std::max(dq, run.dq_largest);
      radius = std::max(radius, run.radius);
      range = std::max(range, run.range_used);
      // A run that never settles counts as slower than all others.
      settle.push_back(run.converged ? run.settle_s : limit_s);
      if (run.converged && run.straight_px > 20.0) {
        path.push_back(run.path_px / run.straight_px);
      }
      if (!run.converged) {
        failed.append(" ").append(std::to_string(k));
      }
    }
    const double share = 100.0 * converged / starts;
    std::printf("%-28s %8.1f%% %8.2f %8.2f %8.2f %8.3f %8.3f %9d %8.4f %8.4f %8.0f\n", way.name.c_str(),
                share, Quantile(settle, 0.5), Quantile(settle, 0.95), dq, Quantile(path, 0.5),
                Quantile(path, 0.95), unseen, radius, range,
                static_cast<double>(spent.count()) / static_cast<double>(calls));
    std::printf("    not converged:%s\n", failed.c_str());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace fovea::control

int main(int argc, char** argv) {
  fovea::control::Compare(argc > 1 ? std::atoi(argv[1]) : 300, argc > 2 ? std::atof(argv[2]) : 10.0);
  return 0;
}
