// Percentiles of durations.
#pragma once

#include <algorithm>
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

}  // namespace fovea::bench
