// What goes with the camera's pictures in the log: its calibration, and what is drawn on them.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/vision/detect/detection.hpp"
#include "firmware/vision/pose/intrinsics.hpp"

namespace foxglove {
class CameraCalibration;
class ImageAnnotations;
}  // namespace foxglove

namespace fovea::log {

foxglove::CameraCalibration CalibrationMessage(std::int64_t time_ns, const vision::Intrinsics& intrinsics);

// Outlines on one picture, drawn where the lens puts them. Each carries the metadata "role": kGoalRole,
// kDetectionRole or kTruthRole.
inline constexpr const char* kGoalRole = "goal";
inline constexpr const char* kDetectionRole = "detection";
inline constexpr const char* kTruthRole = "truth";

// A closed outline of ideal pixels; nothing when it has none.
void AddOutline(const vision::Intrinsics& intrinsics, std::span<const vision::ImagePoint> points,
                const char* role, foxglove::ImageAnnotations& annotations);
// The detection's outline, and its confidence in words; nothing when nothing was found.
void AddDetection(const vision::Intrinsics& intrinsics, const vision::Detection& detection,
                  foxglove::ImageAnnotations& annotations);

}  // namespace fovea::log
