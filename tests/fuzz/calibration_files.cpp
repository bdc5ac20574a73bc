// SPDX-License-Identifier: Apache-2.0
// The files that `fovea calibrate` reads besides images: a camera file and the hand poses.
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/toml_edit.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tools/fovea/calibrate/camera_file.hpp"
#include "tools/fovea/calibrate/hand_poses.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

void JudgeCamera(const vision::Intrinsics& in) {
  Require(in.width_px > 0 && in.height_px > 0, "the image size is positive");
  Require(std::isfinite(in.f_u_px) && in.f_u_px > 0.0 && std::isfinite(in.f_v_px) && in.f_v_px > 0.0,
          "focal lengths are finite and positive");
  // The camera file is written and read back unchanged.
  static const fuzz::InputFile again("again.toml");
  const std::string text = config::SectionText("camera", CameraValues(in, 0.0));
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const vision::Intrinsics back = ReadCameraFile(again.Write(bytes));
  Require(back.width_px == in.width_px && back.height_px == in.height_px &&
              std::fabs(back.f_u_px - in.f_u_px) <= 1e-8 * in.f_u_px,
          "a camera file keeps the size and the focal length");
}

void JudgePoses(const std::vector<HandPose>& poses) {
  for (const HandPose& pose : poses) {
    Require(pose.X_BE.p.allFinite(), "a hand pose's position is finite");
    Require(pose.X_BE.R.allFinite() && std::fabs(pose.X_BE.R.determinant() - 1.0) < 1e-6,
            "a hand pose's rotation has determinant 1");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile camera("camera.toml");
  static const fuzz::InputFile poses("poses.csv");
  fuzz::Bytes input(data, size);
  const bool is_camera = input.Byte() % 2 == 0;
  try {
    if (is_camera) {
      JudgeCamera(ReadCameraFile(camera.Write(input.Rest())));
    } else {
      JudgePoses(ReadHandPoses(poses.Write(input.Rest())));
    }
  } catch (const config::InputError& error) {
    Require(fuzz::IsOneLine(error.what()), "an error message is one line");
  }
  return 0;
}
