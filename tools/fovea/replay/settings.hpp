// SPDX-License-Identifier: Apache-2.0
// fovea replay --set: applies changed keys to a recorded configuration.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"

namespace fovea {

// Reads the keys of the run from the log. Returns a function that applies `assignments` ("servo.lambda=3") to
// a configuration. InputError: a key outside [servo] and [safety], or a value that is not allowed.
std::function<config::ServoConfig(const config::ServoConfig&)> ChangeOf(
    const std::filesystem::path& log, const std::vector<std::string>& assignments);

}  // namespace fovea
