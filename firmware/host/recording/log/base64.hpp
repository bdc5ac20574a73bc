// SPDX-License-Identifier: Apache-2.0
// Bytes as text, for JSON.
#pragma once

#include <string>
#include <string_view>

namespace fovea::log {

// RFC 4648, with padding.
std::string Base64(std::string_view bytes);

}  // namespace fovea::log
