// fovea replay --set: what keys make of a recorded configuration.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "fovea/servo/servo_config.hpp"

namespace fovea {

// Reads from the log what its keys were, and gives the change that `assignments` ("servo.lambda=3") make.
// InputError: a key outside of [servo] and [safety], or a value that is not allowed.
std::function<servo::ServoConfig(const servo::ServoConfig&)> ChangeOf(
    const std::filesystem::path& log, const std::vector<std::string>& assignments);

}  // namespace fovea
