// A camera's intrinsics as a file: what `fovea calibrate intrinsics --out` writes and others read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/config/toml_edit.hpp"
#include "firmware/vision/pose/intrinsics.hpp"

namespace fovea {

// The keys of section [camera] that say so. `rms_px`: how well the views fit.
std::vector<config::NewValue> CameraValues(const vision::Intrinsics& intrinsics, double rms_px);

// As TOML, with the section [camera]. `rms_px` as above.
std::string CameraFileText(const vision::Intrinsics& intrinsics, double rms_px);

// Throws config::InputError: no such file, a key missing or out of range.
vision::Intrinsics ReadCameraFile(const std::filesystem::path& path);

}  // namespace fovea
