// SPDX-License-Identifier: Apache-2.0
// The keys of section [camera] for a real camera: its calibration and its mounting. They read the output of
// `fovea calibrate`.
#pragma once

#include <vector>

#include "firmware/core/model/types.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/vision/intrinsics.hpp"

namespace fovea::config {

struct CalibrationSettings {
  vision::Intrinsics intrinsics{640, 480, 0.0, 0.0, 319.5, 239.5};
  std::vector<double> lens{0.0, 0.0, 0.0, 0.0, 0.0};
  double rms_px = 0.0;                               // rms error of the calibration; 0: unknown
  double mount_rms_mm = 0.0;                         // rms error of the mounting's position; 0: unknown
  std::vector<double> mount_xyz{0.0, 0.0, 0.0};      // p_EC [m]
  std::vector<double> mount_rpy_deg{0.0, 0.0, 0.0};  // R_EC
  double row_time_us = 0.0;                          // of a rolling shutter
};

// Allowed width and height of a picture [px].
struct PictureRange {
  int least = 32;
  int most = 20'000;
};

// The settings must outlive the table.
void AddCalibrationKeys(CalibrationSettings& settings, KeyTable& keys, PictureRange range = {});

// InputError when there is no focal length.
vision::Intrinsics MakeIntrinsics(const CalibrationSettings& settings);
model::Pose MakeMount(const CalibrationSettings& settings);  // X_EC

}  // namespace fovea::config
