// What goes with the camera's pictures in the log: its calibration, and what is drawn on them.
#pragma once

#include <cstdint>

#include "fovea/vision/ball_detector.hpp"
#include "fovea/vision/intrinsics.hpp"

namespace foxglove {
class CameraCalibration;
class ImageAnnotations;
}  // namespace foxglove

namespace fovea::log {

foxglove::CameraCalibration CalibrationMessage(std::int64_t time_ns, const vision::Intrinsics& intrinsics);

// Outlines on one picture. Each carries the metadata "role": kGoalRole, kDetectionRole or kTruthRole.
inline constexpr const char* kGoalRole = "goal";
inline constexpr const char* kDetectionRole = "detection";
inline constexpr const char* kTruthRole = "truth";

// The outline of cone `m` (features/sphere.hpp), dashed or closed.
void AddOutline(const vision::Intrinsics& intrinsics, const model::Vec3& m, const char* role,
                foxglove::ImageAnnotations& annotations);
// The detection's outline, and its confidence in words; nothing when nothing was found.
void AddDetection(const vision::Intrinsics& intrinsics, const vision::BallDetection& detection,
                  foxglove::ImageAnnotations& annotations);

}  // namespace fovea::log
