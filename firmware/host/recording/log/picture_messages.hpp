// SPDX-License-Identifier: Apache-2.0
// The camera's pictures in the log, and the messages that go with them: the calibration and the annotations.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/vision/detection.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "fovea/hal/camera.hpp"

namespace cv {
class Mat;
}

namespace foxglove {
class CameraCalibration;
class CompressedImage;
class ImageAnnotations;
}  // namespace foxglove

namespace fovea::log {

// The frame's pixels, which are not copied.
cv::Mat PictureOf(const hal::Frame& frame);
// Encodes `picture` (grey, or blue, green, red) as JPEG. std::runtime_error: it cannot be encoded.
foxglove::CompressedImage ImageMessage(const cv::Mat& picture, std::int64_t stamp_ns, int jpeg_quality);
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
