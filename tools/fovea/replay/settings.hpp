// fovea replay --set: what keys make of a recorded configuration.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"

namespace fovea {

// Reads from the log what its keys were, and gives the change that `assignments` ("servo.lambda=3") make.
// InputError: a key outside of [servo] and [safety], or a value that is not allowed.
std::function<config::ServoConfig(const config::ServoConfig&)> ChangeOf(
    const std::filesystem::path& log, const std::vector<std::string>& assignments);

}  // namespace fovea
