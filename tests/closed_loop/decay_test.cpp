// SPDX-License-Identifier: Apache-2.0
// With constant gain and after the smooth start the error decays like exp(-lambda t), within 10 %. Noise,
// friction and every limit act as shipped.
#include <algorithm>
#include <cmath>
#include <map>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

struct Decay {
  double worst = 0.0;       // largest relative distance from the exponential
  double duration_s = 0.0;  // length of the comparison
};

// Compares the true error with the exponential, from 0.5 s after Track begins until the error is 3 % of its
// start. Half a second covers the smooth start and the settling of the joints' own loop.
Decay Measure(double lambda) {
  std::map<std::int64_t, double> error;  // |p_CO_C* - p_CO_C| by time, from the simulator's truth
  std::int64_t track_ns = -1;
  const Eigen::Vector3d p_CO_C_star(0.0, 0.0, 0.4);
  sim::RunOptions options;
  options.observer.on_truth = [&](const sim::Truth& truth) {
    error[truth.stamp_ns] = (p_CO_C_star - truth.X_BC.inverse() * truth.p_BO).norm();
  };
  options.observer.on_record = [&](const hal::TickRecord& record) {
    if (track_ns < 0 && record.mode == hal::Mode::kTrack) {
      track_ns = record.stamp_ns;
    }
  };
  ExpectSound(RunShipped(
      "ball", {"servo.lambda=" + std::to_string(lambda), "servo.plans=false", "run.duration_s=4"}, options));
  const std::int64_t begin_ns = track_ns + 500'000'000;
  Decay decay;
  const double e0 = error.at(begin_ns);
  const double floor = 0.03 * error.begin()->second;
  for (auto it = error.find(begin_ns); it != error.end() && it->second > floor; ++it) {
    const double t = static_cast<double>(it->first - begin_ns) * 1e-9;
    decay.worst = std::max(decay.worst, std::fabs(it->second / (e0 * std::exp(-lambda * t)) - 1.0));
    decay.duration_s = t;
  }
  std::cout << "lambda " << lambda << ": within " << 100.0 * decay.worst << " % of exp(-lambda t) for "
            << decay.duration_s << " s\n";
  return decay;
}

TEST(Decay, ErrorFollowsTheExponentialOfTheGain) {
  for (const double lambda : {1.0, 2.0, 3.0}) {
    const Decay decay = Measure(lambda);
    EXPECT_LT(decay.worst, 0.10);
    EXPECT_GT(decay.duration_s * lambda, 1.0) << "the comparison is too short";
  }
}

}  // namespace
}  // namespace fovea::test
