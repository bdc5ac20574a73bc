// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/robustness/results.hpp"

#include <algorithm>

namespace fovea::robustness {

bool KeepsLimits(const Tornado& tornado) {
  const auto keeps = [](const atlas::Figures& figures) {
    return figures.limit_violations == 0 && figures.contact_runs == 0 && figures.without_result == 0;
  };
  return keeps(tornado.none) && keeps(tornado.all) &&
         std::all_of(tornado.bars.begin(), tornado.bars.end(), [&](const BarFigures& one) {
           return std::all_of(one.sides.begin(), one.sides.end(),
                              [&](const auto& side) { return !side || keeps(side->stated); });
         });
}

}  // namespace fovea::robustness
