// SPDX-License-Identifier: Apache-2.0
// Where shipped scenarios, robots and the report's page are.
#pragma once

#include <filesystem>

namespace fovea::config {

// share/fovea beside the folder of the running program, when built and when installed.
std::filesystem::path ShareFolder();

}  // namespace fovea::config
