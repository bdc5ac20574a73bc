// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/design/sampled_loop.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/host/design/characteristic.hpp"
#include "firmware/host/design/linear_system.hpp"

namespace fovea::design {
namespace {

constexpr double kScanStep = 1.002;
constexpr double kFarthestFactor = 1e6;

// Goes from `from` to `to` in geometric steps until `holds` fails for the first time, then bisects that step.
// `holds(known)` must be true.
template <typename Predicate>
std::optional<double> FirstFailure(const Predicate& holds, double known, double from, double to) {
  const double factor = to > from ? kScanStep : 1.0 / kScanStep;
  const auto steps = static_cast<int>(std::ceil(std::log(to / from) / std::log(factor)));
  double good = known;
  for (int i = 0; i <= steps; ++i) {
    double bad = from * std::pow(factor, i);
    if (holds(bad)) {
      good = bad;
      continue;
    }
    for (double middle = 0.5 * (good + bad); middle != good && middle != bad; middle = 0.5 * (good + bad)) {
      (holds(middle) ? good : bad) = middle;
    }
    return good;
  }
  return std::nullopt;
}

// The slowest time constant of plant and closed loop [s].
double SlowestTime(const SampledLoop& loop) {
  double slowest = 0.0;
  for (const SecondOrder& system : {loop.plant, CloseLoop(loop.plant, loop.gains)}) {
    for (const std::complex<double>& pole : Poles(system)) {
      slowest = std::abs(pole) > 0.0 ? std::max(slowest, 1.0 / std::abs(pole)) : slowest;
    }
  }
  return slowest;
}

}  // namespace

Eigen::MatrixXd PeriodMatrix(const SampledLoop& loop) {
  const Discretised plant(loop);
  const Eigen::Index under_way = plant.whole_periods + (plant.fraction > 0.0 ? 1 : 0);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 + under_way, 2 + under_way);
  const Eigen::RowVector2d K(plant.k_p, plant.k_v);
  A.topLeftCorner<2, 2>() = Eigen::Matrix2d::Identity() + plant.Phi_minus_I;
  // The forces that act in the first part and in the rest of this period: delayed ones, or this sample's.
  for (const auto& [age, Gamma] :
       {std::pair{plant.whole_periods, plant.Gamma_0}, std::pair{plant.whole_periods + 1, plant.Gamma_1}}) {
    if (age == 0) {
      A.topLeftCorner<2, 2>() -= Gamma * K;
    } else if (age <= under_way) {
      A.block<2, 1>(0, 1 + age) += Gamma;
    }
  }
  if (under_way > 0) {
    A.block<1, 2>(2, 0) = -K;
    A.bottomRightCorner(under_way - 1, under_way).leftCols(under_way - 1).setIdentity();
  }
  return A;
}

std::vector<std::complex<double>> Poles(const SampledLoop& loop) {
  std::vector<std::complex<double>> poles = Eigenvalues(PeriodMatrix(loop));
  std::sort(poles.begin(), poles.end(), [](const auto& one, const auto& other) {
    const double size_one = std::abs(one);
    const double size_other = std::abs(other);
    return size_one != size_other ? size_one > size_other : one.imag() > other.imag();
  });
  return poles;
}

std::complex<double> EquivalentPole(const std::complex<double>& z, double rate_hz) {
  return std::log(z) * rate_hz;
}

std::optional<int> CountUnstablePoles(const SampledLoop& loop) {
  return RootsWithinUnitCircle(Characteristic(Discretised(loop)));
}

bool IsStable(const SampledLoop& loop) { return CountUnstablePoles(loop) == 0; }

StabilityEdge GainEdge(const SampledLoop& loop) {
  const bool stable = IsStable(loop);
  const auto as_now = [&](double factor) {
    SampledLoop scaled = loop;
    scaled.gains.k_p *= factor;
    scaled.gains.k_v *= factor;
    return IsStable(scaled) == stable;
  };
  const double to = stable ? kFarthestFactor : 1.0 / kFarthestFactor;
  return {FirstFailure(as_now, 1.0, 1.0, to), to};
}

StabilityEdge DelayEdge(const SampledLoop& loop) {
  const double period_s = 1.0 / loop.rate_hz;
  const double to = std::clamp(20.0 * SlowestTime(loop), 100.0 * period_s, kMostPeriods * period_s);
  const auto stable = [&](double delay_s) {
    SampledLoop delayed = loop;
    delayed.delay_s = delay_s;
    return IsStable(delayed);
  };
  if (!stable(0.0)) {
    return {0.0, to};
  }
  return {FirstFailure(stable, 0.0, 1e-3 * period_s, to), to};
}

}  // namespace fovea::design
