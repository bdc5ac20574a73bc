// SPDX-License-Identifier: Apache-2.0
// A camera's intrinsics as a file: `fovea calibrate intrinsics --out` writes it, other commands read it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/config/toml_edit.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea {

// The intrinsics as keys of section [camera]. `rms_px`: residual of the views.
std::vector<config::NewValue> CameraValues(const vision::Intrinsics& intrinsics, double rms_px);

// As TOML, with the section [camera]. `rms_px` as above.
std::string CameraFileText(const vision::Intrinsics& intrinsics, double rms_px);

// Throws config::InputError when the file does not exist, or a key is missing or out of range.
vision::Intrinsics ReadCameraFile(const std::filesystem::path& path);

}  // namespace fovea
