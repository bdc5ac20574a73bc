#include "camera_file.hpp"

#include <fmt/format.h>

#include "fovea/config/input_error.hpp"
#include "fovea/config/key_table.hpp"

namespace fovea {

std::string CameraFileText(const vision::Intrinsics& in) {
  return fmt::format(
      "[camera]\nwidth_px = {}\nheight_px = {}\nf_u_px = {:.9g}\nf_v_px = {:.9g}\nc_u_px = {:.9g}\nc_v_px = "
      "{:.9g}\n"
      "lens = [{:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}]  # k1, k2, p1, p2, k3\n",
      in.width_px, in.height_px, in.f_u_px, in.f_v_px, in.c_u_px, in.c_v_px, in.lens.k1, in.lens.k2,
      in.lens.p1, in.lens.p2, in.lens.k3);
}

vision::Intrinsics ReadCameraFile(const std::filesystem::path& path) {
  vision::Intrinsics in;
  std::vector<double> lens(5, 0.0);
  config::KeyTable keys;
  keys.Integer("camera.width_px", in.width_px, 32, 20000, "px", "of its images");
  keys.Integer("camera.height_px", in.height_px, 32, 20000, "px", "of its images");
  keys.Number("camera.f_u_px", in.f_u_px, 1.0, 1e6, "px", "focal length along u");
  keys.Number("camera.f_v_px", in.f_v_px, 1.0, 1e6, "px", "focal length along v");
  keys.Number("camera.c_u_px", in.c_u_px, -1e5, 1e5, "px", "principal point");
  keys.Number("camera.c_v_px", in.c_v_px, -1e5, 1e5, "px", "principal point");
  keys.Numbers("camera.lens", lens, 5, 5, -1e3, 1e3, "", "k1, k2, p1, p2, k3");
  for (const config::Setting& setting : config::ReadTomlFile(path)) {
    keys.Apply(setting);
  }
  if (in.width_px == 0 || in.height_px == 0 || in.f_u_px == 0.0 || in.f_v_px == 0.0) {
    throw config::InputError(path.string() +
                             ": camera.width_px, height_px, f_u_px, f_v_px, c_u_px and c_v_px are needed");
  }
  in.lens = {lens[0], lens[1], lens[2], lens[3], lens[4]};
  return in;
}

}  // namespace fovea
