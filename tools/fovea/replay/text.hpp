// SPDX-License-Identifier: Apache-2.0
// A replay's result as text and as JSON.
#pragma once

#include <string>

#include "firmware/host/recording/flight/replay.hpp"

namespace fovea {

std::string ReplayText(const std::string& log, const flight::ReplayResult& result);
std::string ReplayJson(const std::string& log, const flight::ReplayResult& result);

// One line per changed field: number of ticks, time of the first, largest change.
std::string ChangeTable(const flight::ReplayResult& result);

}  // namespace fovea
