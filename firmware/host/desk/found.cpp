// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/desk/found.hpp"

namespace fovea::desk {

void Fill(const beliefs::Findings* findings, live::State& state) {
  state.findings.clear();
  if (findings == nullptr) {
    return;
  }
  for (const beliefs::Belief& belief : findings->beliefs) {
    const bool of_joint = belief.name.find("joint") != std::string::npos;
    if (!of_joint || belief.IsWrong()) {
      state.findings.push_back({belief.name, belief.key, belief.unit, belief.configured, belief.IsKnown(),
                                belief.difference, belief.sigma});
    }
  }
}

}  // namespace fovea::desk
