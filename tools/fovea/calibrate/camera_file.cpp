// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/calibrate/camera_file.hpp"

#include <fmt/format.h>

#include <numbers>

#include "firmware/host/config/camera_keys.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/key_table.hpp"

namespace fovea {

std::vector<config::NewValue> CameraValues(const vision::Intrinsics& in, double rms_px) {
  const auto number = [](double value) { return fmt::format("{:.9g}", value); };
  return {{"width_px", fmt::format("{}", in.width_px)},
          {"height_px", fmt::format("{}", in.height_px)},
          {"f_u_px", number(in.f_u_px)},
          {"f_v_px", number(in.f_v_px)},
          {"c_u_px", number(in.c_u_px)},
          {"c_v_px", number(in.c_v_px)},
          {"lens", fmt::format("[{:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}]  # k1, k2, p1, p2, k3", in.lens.k1,
                               in.lens.k2, in.lens.p1, in.lens.p2, in.lens.k3)},
          {"rms_px", fmt::format("{:.4g}", rms_px)}};
}

vision::Intrinsics AssumedCamera(int width_px, int height_px, std::optional<double> f_px) {
  const double f = f_px.value_or(0.5 * width_px * std::numbers::sqrt3);
  return {width_px, height_px, f, f, 0.5 * (width_px - 1), 0.5 * (height_px - 1), {}};
}

vision::Intrinsics ReadCameraFile(const std::filesystem::path& path) {
  config::CalibrationSettings settings;
  settings.intrinsics = vision::Intrinsics{};
  config::KeyTable keys;
  config::AddCalibrationKeys(settings, keys);
  for (const config::Setting& setting : config::ReadTomlFile(path)) {
    keys.Apply(setting);
  }
  const vision::Intrinsics& in = settings.intrinsics;
  if (in.width_px == 0 || in.height_px == 0 || in.f_u_px == 0.0 || in.f_v_px == 0.0) {
    throw config::InputError(path.string() +
                             ": must have camera.width_px, height_px, f_u_px, f_v_px, c_u_px and c_v_px");
  }
  return config::MakeIntrinsics(settings);
}

}  // namespace fovea
