// SPDX-License-Identifier: Apache-2.0
// Robot files: any bytes as a URDF, read directly or named by an arm file, and any bytes in the arm file
// itself. The servo must be able to compute with every arm that is accepted.
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/input_file.hpp"
#include "tests/support/places.hpp"

using fovea::fuzz::Require;
using namespace fovea;

namespace {

void Judge(const model::ArmModel& arm) {
  Require(arm.num_joints >= 1 && arm.num_joints <= model::kMaxJoints, "the number of joints is in its range");
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = arm.joints[k];
    Require(std::isfinite(joint.q_min) && std::isfinite(joint.q_max) && joint.q_min < joint.q_max,
            "a joint's range is finite and not empty");
    Require(arm.q_ready[k] >= joint.q_min && arm.q_ready[k] <= joint.q_max,
            "the ready posture is in the joint ranges");
    for (const double most : {joint.dq_max, joint.ddq_max, joint.dddq_max, joint.tau_max, joint.dtau_max}) {
      Require(std::isfinite(most) && most > 0.0, "limits are finite and positive");
    }
    Require(std::isfinite(joint.viscous) && joint.viscous >= 0.0 && std::isfinite(joint.coulomb) &&
                joint.coulomb >= 0.0,
            "friction is finite and not negative");
    Require(joint.X_PJ.R.allFinite() && joint.X_PJ.p.allFinite(), "a joint's frame is finite");
    Require(std::fabs(joint.X_PJ.R.determinant() - 1.0) < 1e-6, "a joint's rotation has determinant 1");
    Require(std::isfinite(arm.links[k].mass) && arm.links[k].mass > 0.0,
            "a link's mass is finite and positive");
  }
  Require(arm.X_LnE.R.allFinite() && arm.X_LnE.p.allFinite(), "the flange's frame is finite");
}

void Load(const std::filesystem::path& file) {
  try {
    Judge(robots::LoadRobot(file).model);
  } catch (const config::InputError& error) {
    Require(fuzz::IsOneLine(error.what()), "an error message is one line");
  }
}

}  // namespace

// urdfdom leaks some hundred bytes when it refuses a ring of links; this program ends soon after. We free
// every model that urdfdom returns (RobotTest).
extern "C" const char* __lsan_default_suppressions() { return "leak:liburdfdom_model.so\n"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile urdf("arm.urdf");
  static const fuzz::InputFile toml("arm.toml");
  fuzz::Bytes input(data, size);
  const std::uint8_t how = input.Byte();
  const auto rest = input.Rest();
  if (how % 2 == 0) {
    Load(urdf.Write(rest));
    return 0;
  }
  static const std::filesystem::path good = std::filesystem::path(test::RobotsFolder()) / "slider.urdf";
  const std::string named = "urdf = \"" + good.string() + "\"\n";
  std::vector<std::uint8_t> bytes(named.begin(), named.end());
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  Load(toml.Write(bytes));
  return 0;
}
