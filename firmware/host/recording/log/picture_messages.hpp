// SPDX-License-Identifier: Apache-2.0
// Messages that go with the camera's pictures in the log: the calibration and the annotations.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace foxglove {
class CameraCalibration;
class ImageAnnotations;
}  // namespace foxglove

namespace fovea::log {

foxglove::CameraCalibration CalibrationMessage(std::int64_t time_ns, const vision::Intrinsics& intrinsics);

// The roles of outlines on a picture. Each outline has one as its metadata "role", and is drawn with the
// lens's distortion.
inline constexpr const char* kGoalRole = "goal";
inline constexpr const char* kDetectionRole = "detection";
inline constexpr const char* kTruthRole = "truth";

// Adds a closed outline of ideal pixels; nothing when `points` is empty.
void AddOutline(const vision::Intrinsics& intrinsics, std::span<const vision::ImagePoint> points,
                const char* role, foxglove::ImageAnnotations& annotations);
// Adds the detection's outline, and its confidence as text; nothing when nothing was found.
void AddDetection(const vision::Intrinsics& intrinsics, const vision::Detection& detection,
                  foxglove::ImageAnnotations& annotations);

}  // namespace fovea::log
