// SPDX-License-Identifier: Apache-2.0
// A program's keys as text for its user.
#pragma once

#include <cstddef>
#include <string>

#include "firmware/host/config/key_table.hpp"

namespace fovea::config {

// For each key a line `name = default`, then meaning, kind, range and unit, in lines that fit into `width`.
std::string KeysAsText(const KeyTable& keys, std::size_t width);

}  // namespace fovea::config
