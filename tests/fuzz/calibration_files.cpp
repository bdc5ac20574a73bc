// What `fovea calibrate` reads besides pictures: a camera's file, and the hand's poses.
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "firmware/host/config/input_error.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tools/fovea/calibrate/camera_file.hpp"
#include "tools/fovea/calibrate/hand_poses.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

void JudgeCamera(const vision::Intrinsics& in) {
  Require(in.width_px > 0 && in.height_px > 0, "a size");
  Require(std::isfinite(in.f_u_px) && in.f_u_px > 0.0 && std::isfinite(in.f_v_px) && in.f_v_px > 0.0,
          "focal lengths");
  // What is written is read as the same.
  static const fuzz::InputFile again("again.toml");
  const std::string text = CameraFileText(in, 0.0);
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const vision::Intrinsics back = ReadCameraFile(again.Write(bytes));
  Require(back.width_px == in.width_px && back.height_px == in.height_px &&
              std::fabs(back.f_u_px - in.f_u_px) <= 1e-8 * in.f_u_px,
          "a camera's file says what was measured");
}

void JudgePoses(const std::vector<HandPose>& poses) {
  for (const HandPose& pose : poses) {
    Require(pose.X_BE.p.allFinite(), "a place");
    Require(pose.X_BE.R.allFinite() && std::fabs(pose.X_BE.R.determinant() - 1.0) < 1e-6, "a turn");
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
    Require(fuzz::IsOneLine(error.what()), "a refusal is one line");
  }
  return 0;
}
