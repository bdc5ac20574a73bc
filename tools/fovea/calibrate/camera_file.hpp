// A camera's intrinsics as a file: what `fovea calibrate intrinsics --out` writes and others read.
#pragma once

#include <filesystem>
#include <string>

#include "firmware/vision/pose/intrinsics.hpp"

namespace fovea {

// As TOML, with the section [camera]. `rms_px`: how well the views fit.
std::string CameraFileText(const vision::Intrinsics& intrinsics, double rms_px);

// Throws config::InputError: no such file, a key missing or out of range.
vision::Intrinsics ReadCameraFile(const std::filesystem::path& path);

}  // namespace fovea
