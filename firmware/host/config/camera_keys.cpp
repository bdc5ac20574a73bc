// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/camera_keys.hpp"

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"

namespace fovea::config {

void AddCalibrationKeys(CalibrationSettings& settings, KeyTable& keys, PictureRange range) {
  vision::Intrinsics& in = settings.intrinsics;
  keys.Integer("camera.width_px", in.width_px, range.least, range.most, "px", "width of a picture");
  keys.Integer("camera.height_px", in.height_px, range.least, range.most, "px", "height of a picture");
  keys.Number("camera.f_u_px", in.f_u_px, 1.0, 1e6, "px", "focal length along u");
  keys.Number("camera.f_v_px", in.f_v_px, 1.0, 1e6, "px", "focal length along v");
  keys.Number("camera.c_u_px", in.c_u_px, -1e5, 1e5, "px", "principal point");
  keys.Number("camera.c_v_px", in.c_v_px, -1e5, 1e5, "px", "principal point");
  keys.Numbers("camera.lens", settings.lens, 5, 5, -1e3, 1e3, "", "distortion: k1, k2, p1, p2, k3");
  for (const char* former : {"camera.k1", "camera.k2", "camera.p1", "camera.p2", "camera.k3"}) {
    keys.Renamed(former, "camera.lens");
  }
  keys.Number("camera.rms_px", settings.rms_px, 0.0, 1e3, "px",
              "rms error of the calibration, as `fovea calibrate intrinsics` reports; 0: unknown");
  keys.Number("camera.mount_rms_mm", settings.mount_rms_mm, 0.0, 1e3, "mm",
              "rms error of the mounting's position, as `fovea calibrate hand-eye` reports; 0: unknown");
  keys.Numbers("camera.mount_xyz", settings.mount_xyz, 3, 3, -1.0, 1.0, "m", "position of C in E");
  keys.Numbers("camera.mount_rpy_deg", settings.mount_rpy_deg, 3, 3, -360.0, 360.0, "deg",
               "orientation of C in E: roll, pitch, yaw about fixed axes");
  keys.Number(
      "camera.row_time_us", settings.row_time_us, 0.0, 1e3, "us",
      "rolling shutter: time from the exposure of one row to that of the next, from top to bottom; the "
      "stamp is that of the middle row; 0: all rows at once");
}

vision::Intrinsics MakeIntrinsics(const CalibrationSettings& settings) {
  vision::Intrinsics in = settings.intrinsics;
  if (in.f_u_px <= 0.0 || in.f_v_px <= 0.0) {
    throw InputError(
        "camera.f_u_px and camera.f_v_px are needed: copy the output of `fovea calibrate intrinsics` into "
        "[camera]");
  }
  const std::vector<double>& k = settings.lens;
  in.lens = {k[0], k[1], k[2], k[3], k[4]};
  in.row_time = 1e-6 * settings.row_time_us;
  return in;
}

model::Pose MakeMount(const CalibrationSettings& settings) {
  const std::vector<double>& p = settings.mount_xyz;
  return {RollPitchYaw(settings.mount_rpy_deg), model::Vec3(p[0], p[1], p[2])};
}

}  // namespace fovea::config
