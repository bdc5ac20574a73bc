// SPDX-License-Identifier: Apache-2.0
// Durations: measuring them, their percentiles, and the confidence interval of a ratio of percentiles.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <vector>

namespace fovea::bench {

// Percentile `p` (0 to 1) of `values`; 0 when there are none.
inline double Percentile(std::vector<double> values, double p) {
  if (values.empty()) {
    return 0.0;
  }
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(p * last + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Mean duration [ns] of `call` over all `cases`, measured once.
template <typename Cases, typename Call>
double MeanNs(Cases& cases, const Call& call) {
  const auto begin = std::chrono::steady_clock::now();
  for (auto& each : cases) {
    call(each);
  }
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
  return took.count() / static_cast<double>(std::size(cases));
}

// Median of MeanNs over `rounds` measurements [ns].
template <typename Cases, typename Call>
double MedianNs(int rounds, Cases& cases, const Call& call) {
  std::vector<double> means;
  means.reserve(static_cast<std::size_t>(rounds));
  for (int round = 0; round < rounds; ++round) {
    means.push_back(MeanNs(cases, call));
  }
  return Percentile(means, 0.5);
}

struct Ratio {
  double value = 0.0;  // ratio of the percentiles of all blocks together
  double low = 0.0;    // its 90 % interval
  double high = 0.0;
};

// Percentile `p` of `above` divided by that of `below`. Both were measured in turns: block i of one next to
// block i of the other. The interval comes from drawing such pairs with replacement (bootstrap), so a
// disturbance that affects both blocks of a pair cancels. Blocks that only one of them has are ignored. All
// values are 0 when no pair is left or the percentile of `below` is 0.
Ratio RatioOfPercentiles(const std::vector<std::vector<double>>& above,
                         const std::vector<std::vector<double>>& below, double p, unsigned seed = 1);

// Counts in bins whose edges are powers of 2^(1/4), from the bin of the least value to that of the largest.
// Values below 1 are in the bin from 0 to 1.
struct LogHistogram {
  struct Bin {
    double low = 0.0;
    double high = 0.0;
    std::int64_t count = 0;
  };
  std::vector<Bin> bins;  // adjacent, without gaps
};
LogHistogram CountByLog(const std::vector<double>& values);

}  // namespace fovea::bench
