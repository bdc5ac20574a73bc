// SPDX-License-Identifier: Apache-2.0
// The topics of a log, and the type of their messages.
#pragma once

namespace fovea::log {

inline constexpr const char* kTickTopic = "/servo/tick";          // fovea.log.Tick
inline constexpr const char* kFeatureTopic = "/servo/feature";    // fovea.log.Feature
inline constexpr const char* kEventTopic = "/servo/events";       // foxglove.Log: modes and faults as text
inline constexpr const char* kKeyframeTopic = "/servo/keyframe";  // fovea.log.Keyframe
inline constexpr const char* kConfigurationTopic = "/servo/configuration";  // fovea.log.ServoConfiguration
inline constexpr const char* kTickTimesTopic = "/servo/tick_times";         // fovea.log.TickTimes
inline constexpr const char* kSetupTopic = "/setup";                        // fovea.log.Setup
inline constexpr const char* kTruthTopic = "/truth";                        // fovea.log.Truth; simulator only
inline constexpr const char* kImageTopic = "/camera/image";                 // foxglove.CompressedImage, JPEG
inline constexpr const char* kAnnotationTopic = "/camera/annotations";      // foxglove.ImageAnnotations
inline constexpr const char* kCalibrationTopic = "/camera/calibration";     // foxglove.CameraCalibration
inline constexpr const char* kTransformTopic = "/tf";                       // foxglove.FrameTransforms
inline constexpr const char* kTheoryTopic = "/theory";                      // fovea.log.Theory
inline constexpr const char* kOperatorTopic = "/operator";                  // fovea.log.Touch
inline constexpr const char* kSceneTopic = "/scene";                        // foxglove.SceneUpdate

// Frames of /tf that are not links of the robot; no link has such a name.
inline constexpr const char* kBaseFrame = "fovea/base";      // B
inline constexpr const char* kCameraFrame = "fovea/camera";  // C
inline constexpr const char* kTargetFrame = "fovea/target";  // O, as predicted by the servo

}  // namespace fovea::log
