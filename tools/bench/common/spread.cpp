// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/common/spread.hpp"

#include <cmath>
#include <map>
#include <random>

namespace fovea::bench {
namespace {

constexpr int kResamples = 2000;
constexpr int kBinsPerOctave = 4;

struct Ranked {
  double value = 0.0;
  std::size_t block = 0;
};

// All values of the first `count` blocks in descending order. One pass from the top then finds a percentile
// of any selection of blocks.
class RankedBlocks {
 public:
  RankedBlocks(const std::vector<std::vector<double>>& blocks, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      sizes_.push_back(blocks[i].size());
      for (const double value : blocks[i]) {
        ranked_.push_back({value, i});
      }
    }
    std::sort(ranked_.begin(), ranked_.end(),
              [](const Ranked& a, const Ranked& b) { return a.value > b.value; });
  }

  // Percentile `p` of the values when block i counts `times[i]` times.
  [[nodiscard]] double Percentile(const std::vector<std::size_t>& times, double p) const {
    std::size_t total = 0;
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
      total += times[i] * sizes_[i];
    }
    if (total == 0) {
      return 0.0;
    }
    const auto rank = static_cast<std::size_t>(std::llround(p * static_cast<double>(total - 1)));
    std::size_t above = total - 1 - rank;  // number of values that are larger
    for (const Ranked& entry : ranked_) {
      if (above < times[entry.block]) {
        return entry.value;
      }
      above -= times[entry.block];
    }
    return 0.0;
  }

 private:
  std::vector<Ranked> ranked_;
  std::vector<std::size_t> sizes_;
};

}  // namespace

Ratio RatioOfPercentiles(const std::vector<std::vector<double>>& above,
                         const std::vector<std::vector<double>>& below, double p, unsigned seed) {
  const std::size_t pairs = std::min(above.size(), below.size());
  if (pairs == 0) {
    return {};
  }
  const RankedBlocks ranked_above(above, pairs);
  const RankedBlocks ranked_below(below, pairs);
  const auto ratio = [&](const std::vector<std::size_t>& times) {
    const double divisor = ranked_below.Percentile(times, p);
    return divisor > 0.0 ? ranked_above.Percentile(times, p) / divisor : 0.0;
  };
  std::mt19937_64 engine(seed);
  std::uniform_int_distribution<std::size_t> pick(0, pairs - 1);
  std::vector<double> ratios;
  ratios.reserve(kResamples);
  for (int k = 0; k < kResamples; ++k) {
    std::vector<std::size_t> times(pairs, 0);
    for (std::size_t i = 0; i < pairs; ++i) {
      ++times[pick(engine)];
    }
    ratios.push_back(ratio(times));
  }
  return {ratio(std::vector<std::size_t>(pairs, 1)), Percentile(ratios, 0.05), Percentile(ratios, 0.95)};
}

LogHistogram CountByLog(const std::vector<double>& values) {
  std::map<int, std::int64_t> counts;
  for (const double value : values) {
    ++counts[value < 1.0 ? -1 : static_cast<int>(std::floor(kBinsPerOctave * std::log2(value)))];
  }
  LogHistogram histogram;
  if (counts.empty()) {
    return histogram;
  }
  const auto edge = [](int bin) {
    return bin < 0 ? 0.0 : std::exp2(static_cast<double>(bin) / kBinsPerOctave);
  };
  for (int bin = counts.begin()->first; bin <= counts.rbegin()->first; ++bin) {
    const auto found = counts.find(bin);
    histogram.bins.push_back({edge(bin), edge(bin + 1), found == counts.end() ? 0 : found->second});
  }
  return histogram;
}

}  // namespace fovea::bench
