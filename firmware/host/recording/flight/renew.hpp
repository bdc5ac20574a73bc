// SPDX-License-Identifier: Apache-2.0
// Rewrites a log: keeps its inputs, and replaces its outputs by those of the linked servo.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace fovea::flight {

// `build`: BuildEntries() of this program. Keeps only the data that a replay needs. std::runtime_error, with
// the file unchanged: it cannot be read or written, or ticks are missing in it.
void Renew(const std::filesystem::path& log, const std::map<std::string, std::string>& build);

}  // namespace fovea::flight
