// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/solids.hpp"

#include <fmt/format.h>

#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/config/input_error.hpp"
#include "sim/scenario/to_vector.hpp"

namespace fovea::sim {
namespace {

// An arm at its start, and one solid at a time.
class StartCheck {
 public:
  StartCheck(const Scenario& scenario, const config::ServoConfig& servo) : among_(servo) {
    const Eigen::Map<const Eigen::VectorXd> q_start(scenario.arm.q_start.data(), servo.arm.num_joints);
    model::ComputePoses(servo.arm, q_start, poses_);
  }

  void Against(const config::Plane& plane, int number) {
    among_.guard.obstacles = {};
    among_.guard.obstacles.num_planes = 1;
    among_.guard.obstacles.planes[0] = plane;
    Refuse(fmt::format("plane {} of safety.planes", number));
  }
  void Against(const config::Box& box, const char* key, int number) {
    among_.guard.obstacles = {};
    among_.guard.obstacles.num_boxes = 1;
    among_.guard.obstacles.boxes[0] = box;
    Refuse(fmt::format("box {} of {}", number, key));
  }

 private:
  void Refuse(const std::string& solid) const {
    if (const double clearance = barriers::ClearanceOfArm(among_, poses_); !(clearance > 0.0)) {
      throw config::InputError(
          fmt::format("arm.q_start is not allowed: hand, camera, tools or links are {:.3f} m inside {}",
                      -clearance, solid));
    }
  }

  config::ServoConfig among_;
  model::ArmPoses poses_;
};

}  // namespace

std::vector<Eigen::AlignedBox3d> BenchBoxes(const Scenario& scenario) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const config::Box& box : config::MakeBoxes("bench.boxes", scenario.boxes)) {
    boxes.emplace_back(box.low, box.high);
  }
  return boxes;
}

void CheckSolids(const Scenario& scenario, const config::ServoConfig& servo) {
  const config::Obstacles& known = servo.guard.obstacles;
  StartCheck start(scenario, servo);
  for (int i = 0; i < known.num_planes; ++i) {
    start.Against(known.planes[static_cast<std::size_t>(i)], i + 1);
  }
  for (int i = 0; i < known.num_boxes; ++i) {
    start.Against(known.boxes[static_cast<std::size_t>(i)], "safety.boxes", i + 1);
  }
  const std::vector<Eigen::AlignedBox3d> boxes = BenchBoxes(scenario);
  if (!boxes.empty() && scenario.target.motion == "pushed") {
    throw config::InputError(
        "bench.boxes is not allowed with target.motion = \"pushed\": a pushed ball touches the table only");
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    start.Against(config::Box{boxes[i].min(), boxes[i].max()}, "bench.boxes", number);
    if (scenario.camera.enabled && boxes[i].contains(ToVector(scenario.target.position))) {
      throw config::InputError(
          fmt::format("target.position is not allowed: it is in box {} of bench.boxes", number));
    }
  }
}

}  // namespace fovea::sim
