// SPDX-License-Identifier: Apache-2.0
// A camera's intrinsics as a file: `fovea calibrate intrinsics --out` writes it, other commands read it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/toml_edit.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea {

// The intrinsics as keys of section [camera]. `rms_px`: residual of the views.
std::vector<config::NewValue> CameraValues(const vision::Intrinsics& intrinsics, double rms_px);

// A camera without distortion, whose optical axis meets the middle of the picture. `f_px`: its focal length;
// default: a horizontal field of view of 60 degrees.
vision::Intrinsics AssumedCamera(int width_px, int height_px, std::optional<double> f_px = std::nullopt);

// Throws config::InputError when the file does not exist, or a key is missing or out of range.
vision::Intrinsics ReadCameraFile(const std::filesystem::path& path);

}  // namespace fovea
