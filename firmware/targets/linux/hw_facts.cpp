// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_facts.hpp"

#include <algorithm>

#include "firmware/targets/linux/hw_scene.hpp"

namespace fovea::hw {
namespace {

constexpr std::size_t kTickRing = 8192;  // ticks that may wait for the disk: eight seconds
constexpr std::size_t kMostImages = 32;

// Radius of the sphere about the target's centre that encloses the target [m].
double Reach(const features::TargetFeature& target) {
  const features::TargetOutline outline = target.Outline();
  double reach = 0.0;
  for (int i = 0; i < outline.num_points; ++i) {
    reach = std::max(reach, outline.p_OP[static_cast<std::size_t>(i)].norm() + outline.radius);
  }
  return reach;
}

run::RunFacts FactsOf(const HwConfig& config, const robots::Robot& robot, const config::ServoConfig& servo,
                      double duration_s) {
  run::RunFacts facts;
  facts.name = config.name;
  facts.robot = robot.name;
  facts.joint_names = robot.joint_names;
  facts.servo = servo;
  facts.has_camera = config.HasCamera();
  facts.duration_s = duration_s;
  HwConfig values = config;
  facts.keys = HwKeys(values).Values();
  HwConfig defaults;
  facts.default_keys = HwKeys(defaults).Values();
  defaults.robot.driver = config.robot.driver;
  facts.default_keys.merge(HwKeys(defaults).Values());  // those of the driver that is used
  facts.frames = MakeLinkFrames(robot, config.HasCamera(), config::MakeMount(config.camera.calibration));
  facts.scene = MakeSceneMessage(robot, config.HasCamera(), servo.feature);
  if (config.HasCamera()) {
    facts.intrinsics = config::MakeIntrinsics(config.camera.calibration);
    facts.target_radius = Reach(servo.feature);
  }
  return facts;
}

}  // namespace

run::RunFolderConfig FolderOf(const HwConfig& config, const robots::Robot& robot,
                              const config::ServoConfig& servo, const std::string& out, double duration_s,
                              const std::string& command, const log::LogTap& tap) {
  run::RunFolderConfig folder;
  if (out.empty()) {
    return folder;
  }
  folder.out = out;
  folder.facts = FactsOf(config, robot, servo, duration_s);
  folder.facts->command = command;
  folder.options.may_drop = true;
  folder.options.ring = kTickRing;
  folder.options.most_images = kMostImages;
  folder.options.film = config.log.film;
  folder.options.picture_rate_hz = config.log.picture_rate_hz;
  folder.options.tap = tap;
  return folder;
}

beliefs::Configured ConfiguredBeliefs(const HwConfig& config) {
  // Only where the camera's clock cannot be read is the latency configured.
  const double transport_ms = config.camera.transport_ms;
  return {transport_ms > 0.0 ? std::optional(transport_ms) : std::nullopt, config::MakeLoad(config.arm.load),
          "camera.transport_ms"};
}

beliefs::Learns LearnsOf(const HwConfig& config) {
  const config::LearntQuantities learnt = config::LearntOf(config.servo);
  return {learnt.latency, learnt.payload};
}

}  // namespace fovea::hw
