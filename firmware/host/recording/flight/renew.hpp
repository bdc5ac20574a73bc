// Writes a log anew: its inputs as they are, its outputs as the servo that is linked in gives them.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace fovea::flight {

// `build`: of this program, as in BuildEntries(). What a replay needs is kept, and nothing else.
// std::runtime_error, with the file as it was: it cannot be read or written, or ticks are missing in it.
void Renew(const std::filesystem::path& log, const std::map<std::string, std::string>& build);

}  // namespace fovea::flight
