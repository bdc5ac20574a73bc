// A replay's result in words, and as JSON.
#pragma once

#include <string>

#include "firmware/host/recording/flight/replay.hpp"

namespace fovea {

std::string ReplayText(const std::string& log, const flight::ReplayResult& result);
std::string ReplayJson(const std::string& log, const flight::ReplayResult& result);

// The fields that changed, a line each: in how many ticks, since when, by how much at most.
std::string ChangeTable(const flight::ReplayResult& result);

}  // namespace fovea
