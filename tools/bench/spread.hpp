// Percentiles of durations, and how sure their ratio is.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace fovea::bench {

// The value that a share `p` of `values` does not pass; 0 when there are none.
inline double Percentile(std::vector<double> values, double p) {
  if (values.empty()) {
    return 0.0;
  }
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(p * last + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Ratio {
  double value = 0.0;  // of both percentiles, all blocks together
  double low = 0.0;    // its 90 % interval
  double high = 0.0;
};

// Percentile `p` of `above` over that of `below`, which were measured block by block in turns: block i of one
// beside block i of the other. The interval is by drawing such pairs with replacement (bootstrap), so that
// what one disturbed minute did to both cancels. Blocks that only one of them has are left out; all 0 where
// none are left or the lower percentile is 0.
Ratio RatioOfPercentiles(const std::vector<std::vector<double>>& above,
                         const std::vector<std::vector<double>>& below, double p, unsigned seed = 1);

// Counts in bins whose edges are powers of 2^(1/4), from the bin of the least value to that of the most.
// Values of 0 and below are in the bin from 0 to the first edge, 1.
struct LogHistogram {
  struct Bin {
    double low = 0.0;
    double high = 0.0;
    std::int64_t count = 0;
  };
  std::vector<Bin> bins;  // one beside the other, none left out
};
LogHistogram CountByLog(const std::vector<double>& values);

}  // namespace fovea::bench
