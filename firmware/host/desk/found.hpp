// SPDX-License-Identifier: Apache-2.0
// A run's findings so far, for viewers.
#pragma once

#include "firmware/host/beliefs/belief.hpp"
#include "firmware/host/live/state.hpp"

namespace fovea::desk {

// Sets state.findings, without what is told of each joint unless it is wrong: a page has no room for it.
// `findings`: null before the first.
void Fill(const beliefs::Findings* findings, live::State& state);

}  // namespace fovea::desk
