// A program's keys as text for its user.
#pragma once

#include <string>

#include "firmware/host/config/key_table.hpp"

namespace fovea::config {

// Two lines each: `name = default`, then meaning, kind, range and unit.
std::string KeysAsText(const KeyTable& keys);

}  // namespace fovea::config
