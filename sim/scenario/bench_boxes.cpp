// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/bench_boxes.hpp"

#include <fmt/format.h>

#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/config/input_error.hpp"

namespace fovea::sim {

std::vector<Eigen::AlignedBox3d> BenchBoxes(const Scenario& scenario) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const config::Box& box : config::MakeBoxes("bench.boxes", scenario.boxes)) {
    boxes.emplace_back(box.low, box.high);
  }
  return boxes;
}

void CheckBenchBoxes(const Scenario& scenario, const config::ServoConfig& servo) {
  const std::vector<config::Box> boxes = config::MakeBoxes("bench.boxes", scenario.boxes);
  if (!boxes.empty() && scenario.target.motion == "pushed") {
    throw config::InputError(
        "bench.boxes is not allowed with target.motion = \"pushed\": a pushed ball touches the table only");
  }
  model::ArmPoses poses;
  const Eigen::Map<const Eigen::VectorXd> q_start(scenario.arm.q_start.data(), servo.arm.num_joints);
  model::ComputePoses(servo.arm, q_start, poses);
  config::ServoConfig among = servo;
  among.guard.obstacles = {};
  among.guard.obstacles.num_boxes = 1;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    among.guard.obstacles.boxes[0] = boxes[i];
    if (const double clearance = barriers::ClearanceOfArm(among, poses); !(clearance > 0.0)) {
      throw config::InputError(
          fmt::format("bench.boxes: box {} is not allowed: at arm.q_start, hand, camera, tools or links are "
                      "{:.3f} m inside it",
                      i + 1, -clearance));
    }
  }
}

}  // namespace fovea::sim
