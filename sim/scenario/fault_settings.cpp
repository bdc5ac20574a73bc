#include "sim/scenario/fault_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "firmware/host/config/input_error.hpp"
#include "sim/scenario/roll_pitch_yaw.hpp"

namespace fovea::sim {
namespace {

using config::InputError;

TimeWindow ToWindow(const std::vector<double>& window_s) { return {window_s[0], window_s[1]}; }

std::int64_t NsOfMs(double ms) { return static_cast<std::int64_t>(ms * 1e6); }
std::int64_t NsOfSeconds(double s) { return static_cast<std::int64_t>(s * 1e9); }

void AddEyeKeys(FaultSettings& f, config::KeyTable& keys) {
  const auto window = [&](const char* name, std::vector<double>& field, const char* meaning) {
    keys.Numbers(name, field, 2, 2, 0.0, 1e6, "s", meaning);
  };
  window("faults.camera_outage_s", f.camera_outage_s,
         "the camera delivers nothing from the first time to the second");
  window("faults.frame_loss_s", f.frame_loss_s, "frames get lost from the first time to the second");
  keys.Number("faults.frame_loss", f.frame_loss, 0.0, 1.0, "", "share of them, by chance");
  window(
      "faults.freeze_s", f.freeze_s,
      "the camera shows the same scene again and again, with new stamps, from the first time to the second");
  keys.Flag("faults.freeze_pixels", f.freeze_pixels,
            "then all its pixels stay equal; false: each picture has noise of its own");
  window("faults.replay_s", f.replay_s, "the camera shows the scene as it was before, with new stamps");
  keys.Number("faults.replay_delay_s", f.replay_delay_s, 0.0, 1e3, "s",
              "so long before; the first scene where there is none so old");
  window("faults.mirror_s", f.mirror_s, "the camera's pictures are mirrored, left is right");
  window("faults.stamp_s", f.stamp_s, "the frames' stamps are off; the frames come when they would");
  keys.Number("faults.stamp_ms", f.stamp_ms, -1e4, 1e4, "ms",
              "by so much; above 0 a frame says that it is younger than it is");
  window("faults.latency_s", f.latency_s,
         "frames exposed from the first time to the second arrive later; those behind them wait");
  keys.Number("faults.latency_ms", f.latency_ms, 0.0, 1e4, "ms", "by so much, besides camera.latency_ms");
  window("faults.glare_s", f.glare_s, "a glare saturates a spot of the picture");
  keys.Numbers("faults.glare_px", f.glare_px, 3, 3, -4096.0, 8192.0, "px",
               "u and v of its middle, its radius; it fades out over half as far again");
  window("faults.occluder_s", f.occluder_s, "something dark hides a part of the picture");
  keys.Numbers("faults.occluder_px", f.occluder_px, 4, 4, -4096.0, 8192.0, "px",
               "u and v of its middle, its width and height");
  window("faults.wrong_detection_s", f.wrong_detection_s, "the detector is wrong about where the target is");
  keys.Number("faults.wrong_detection", f.wrong_detection, 0.0, 1.0, "",
              "share of the measurements that are wrong, by chance");
  keys.Numbers("faults.wrong_detection_shift", f.wrong_detection_shift, 1, hal::kMaxFeatureDim, -1e6, 1e6,
               "units of s", "by how much, entry by entry; a sphere's s is its centre in radii");
  window("faults.nan_detection_s", f.nan_detection_s, "the detector gives a value that is no number");
}

void AddBodyKeys(FaultSettings& f, config::KeyTable& keys) {
  const auto window = [&](const char* name, std::vector<double>& field, const char* meaning) {
    keys.Numbers(name, field, 2, 2, 0.0, 1e6, "s", meaning);
  };
  const auto joint = [&](const char* name, int& field) {
    keys.Integer(name, field, 1, hal::kMaxJoints, "", "which joint's, counted from 1");
  };
  window("faults.encoder_stuck_s", f.encoder_stuck_s,
         "an encoder stays at its value from the first time to the second");
  keys.Integer("faults.encoder_stuck_joint", f.encoder_stuck_joint, 0, hal::kMaxJoints, "",
               "which joint's, counted from 1; 0: all of them");
  window("faults.encoder_noise_s", f.encoder_noise_s, "a burst of noise on all encoders");
  keys.Number("faults.encoder_noise", f.encoder_noise, 0.0, 10.0, "rad",
              "its standard deviation on positions");
  keys.Number("faults.velocity_noise", f.velocity_noise, 0.0, 100.0, "rad/s", "and on velocities");
  window("faults.encoder_nan_s", f.encoder_nan_s, "an encoder gives a value that is no number");
  joint("faults.encoder_nan_joint", f.encoder_nan_joint);
  window("faults.packet_loss_s", f.packet_loss_s, "states of the arm get lost");
  keys.Number("faults.packet_loss", f.packet_loss, 0.0, 1.0, "", "share of them, by chance");
  window("faults.clock_jump_s", f.clock_jump_s, "the arm's stamps are off");
  keys.Number("faults.clock_jump_ms", f.clock_jump_ms, -1e4, 1e4, "ms", "by so much; below 0 they go back");
  window("faults.deadline_miss_s", f.deadline_miss_s, "the servo's computer swallows ticks");
  keys.Number("faults.deadline_miss", f.deadline_miss, 0.0, 1.0, "", "share of them, by chance");
  window("faults.torque_loss_s", f.torque_loss_s,
         "a joint's motor gives less than it should, of the command and against gravity");
  joint("faults.torque_loss_joint", f.torque_loss_joint);
  keys.Number("faults.torque_loss", f.torque_loss, 0.0, 1.0, "", "share that does not arrive");
  window("faults.load_s", f.load_s, "a mass hangs at the end effector that nobody was told of");
  keys.Number("faults.load_mass", f.load_mass, 0.0, 100.0, "kg", "its mass");
  window("faults.gravity_s", f.gravity_s,
         "the arm's base leans, and the robot's own compensation of its weight does not know");
  keys.Number("faults.gravity_tilt_deg", f.gravity_tilt_deg, -180.0, 180.0, "deg",
              "by so much, about the base's x");
  keys.Numbers("faults.push", f.push, 1, hal::kMaxJoints, -1e4, 1e4, "Nm",
               "torques that push the joints from outside, one per joint; nothing does when not given");
  window("faults.push_s", f.push_s, "from the first time to the second");
  window("faults.nothing_s", f.nothing_s,
         "nothing goes wrong; summary.json says what the servo noticed, to compare a fault's run with");
}

struct Window {
  const char* name;
  const std::vector<double>& window_s;
};

std::array<Window, 22> WindowsOf(const FaultSettings& f) {
  return {{{"camera_outage", f.camera_outage_s},
           {"frame_loss", f.frame_loss_s},
           {"freeze", f.freeze_s},
           {"replay", f.replay_s},
           {"mirror", f.mirror_s},
           {"stamp", f.stamp_s},
           {"latency", f.latency_s},
           {"glare", f.glare_s},
           {"occluder", f.occluder_s},
           {"wrong_detection", f.wrong_detection_s},
           {"nan_detection", f.nan_detection_s},
           {"encoder_stuck", f.encoder_stuck_s},
           {"encoder_noise", f.encoder_noise_s},
           {"encoder_nan", f.encoder_nan_s},
           {"packet_loss", f.packet_loss_s},
           {"clock_jump", f.clock_jump_s},
           {"deadline_miss", f.deadline_miss_s},
           {"torque_loss", f.torque_loss_s},
           {"load", f.load_s},
           {"gravity", f.gravity_s},
           {"push", f.push_s},
           {"nothing", f.nothing_s}}};
}

}  // namespace

std::vector<FaultWindow> FaultsOf(const FaultSettings& faults) {
  std::vector<FaultWindow> met;
  for (const Window& w : WindowsOf(faults)) {
    if (w.window_s[1] > w.window_s[0]) {
      met.push_back({w.name, w.window_s[0], w.window_s[1]});
    }
  }
  return met;
}

void AddFaultKeys(FaultSettings& faults, config::KeyTable& keys) {
  AddEyeKeys(faults, keys);
  AddBodyKeys(faults, keys);
}

void CheckFaults(const FaultSettings& f, int num_joints) {
  for (const Window& w : WindowsOf(f)) {
    if (w.window_s[0] > w.window_s[1]) {
      throw InputError(fmt::format("faults.{}_s = [{}, {}] is not allowed: it ends before it begins", w.name,
                                   w.window_s[0], w.window_s[1]));
    }
  }
  struct Joint {
    const char* key;
    const std::vector<double>& window_s;
    int joint;
  };
  for (const Joint& j : {Joint{"encoder_stuck_joint", f.encoder_stuck_s, f.encoder_stuck_joint},
                         {"encoder_nan_joint", f.encoder_nan_s, f.encoder_nan_joint},
                         {"torque_loss_joint", f.torque_loss_s, f.torque_loss_joint}}) {
    if (j.window_s[1] > j.window_s[0] && j.joint > num_joints) {
      throw InputError(
          fmt::format("faults.{} = {} is not allowed: the arm has {} joints", j.key, j.joint, num_joints));
    }
  }
  const auto check_size = [](const char* key, double size_px) {
    if (size_px <= 0.0) {
      throw InputError(fmt::format("faults.{} is not allowed: its size must be above 0 px", key));
    }
  };
  check_size("glare_px", f.glare_px[2]);
  check_size("occluder_px", f.occluder_px[2]);
  check_size("occluder_px", f.occluder_px[3]);
}

void CheckServedFaults(const FaultSettings& f) {
  struct Fault {
    const char* key;
    const std::vector<double>& window_s;
    const char* instead;
  };
  for (const Fault& fault : {Fault{"wrong_detection_s", f.wrong_detection_s, "the detector is the client's"},
                             {"nan_detection_s", f.nan_detection_s, "the detector is the client's"},
                             {"stamp_s", f.stamp_s, "the client compares clocks itself"},
                             {"encoder_stuck_s", f.encoder_stuck_s, "a Panda keeps its encoders' faults"},
                             {"encoder_noise_s", f.encoder_noise_s, "arm.encoder_noise has a lasting one"},
                             {"encoder_nan_s", f.encoder_nan_s, "a Panda keeps its encoders' faults"},
                             {"packet_loss_s", f.packet_loss_s, "--loss loses packets"},
                             {"clock_jump_s", f.clock_jump_s, "stamps are the robot's own time"},
                             {"deadline_miss_s", f.deadline_miss_s, "the ticks are the client's"}}) {
    if (fault.window_s[1] > fault.window_s[0]) {
      throw InputError(fmt::format("faults.{} = [{}, {}] is not allowed with serve: {}", fault.key,
                                   fault.window_s[0], fault.window_s[1], fault.instead));
    }
  }
}

ArmFaults MakeArmFaults(const FaultSettings& f, std::uint64_t seed) {
  ArmFaults faults;
  faults.stuck = {ToWindow(f.encoder_stuck_s), f.encoder_stuck_joint - 1};
  faults.noise = {ToWindow(f.encoder_noise_s), f.encoder_noise, f.velocity_noise};
  faults.not_a_number = {ToWindow(f.encoder_nan_s), f.encoder_nan_joint - 1};
  faults.clock_jump = {ToWindow(f.clock_jump_s), NsOfMs(f.clock_jump_ms)};
  faults.packet_loss = {ToWindow(f.packet_loss_s), f.packet_loss};
  faults.seed = seed;
  return faults;
}

StallFault MakeStallFault(const FaultSettings& f, std::uint64_t seed) {
  return {ToWindow(f.deadline_miss_s), f.deadline_miss, seed};
}

FrameFaults MakeFrameFaults(const FaultSettings& f, std::uint64_t seed) {
  FrameFaults faults;
  faults.loss = {ToWindow(f.frame_loss_s), f.frame_loss};
  faults.freeze = ToWindow(f.freeze_s);
  faults.freeze_pixels = f.freeze_pixels;
  faults.replay = {ToWindow(f.replay_s), NsOfSeconds(f.replay_delay_s)};
  faults.stamp = {ToWindow(f.stamp_s), NsOfMs(f.stamp_ms)};
  faults.late = {ToWindow(f.latency_s), NsOfMs(f.latency_ms)};
  faults.seed = seed;
  return faults;
}

DetectorFaults MakeDetectorFaults(const FaultSettings& f, std::uint64_t seed) {
  DetectorFaults faults;
  faults.wrong.window = ToWindow(f.wrong_detection_s);
  faults.wrong.share = f.wrong_detection;
  std::copy(f.wrong_detection_shift.begin(), f.wrong_detection_shift.end(), faults.wrong.shift.begin());
  faults.not_a_number = ToWindow(f.nan_detection_s);
  faults.seed = seed;
  return faults;
}

PictureFaults MakePictureFaults(const FaultSettings& f) {
  PictureFaults faults;
  faults.glare = {ToWindow(f.glare_s), f.glare_px[0], f.glare_px[1], f.glare_px[2]};
  faults.occluder = {ToWindow(f.occluder_s), f.occluder_px[0], f.occluder_px[1], f.occluder_px[2],
                     f.occluder_px[3]};
  faults.mirror = ToWindow(f.mirror_s);
  return faults;
}

void SetBenchFaults(const FaultSettings& f, WorldConfig& world) {
  world.camera_outage = ToWindow(f.camera_outage_s);
  world.push = {Eigen::Map<const Eigen::VectorXd>(f.push.data(), static_cast<Eigen::Index>(f.push.size())),
                ToWindow(f.push_s)};
  world.torque_loss = {ToWindow(f.torque_loss_s), f.torque_loss_joint - 1, f.torque_loss};
  world.base_tilt = {ToWindow(f.gravity_s),
                     f.gravity_s[1] > f.gravity_s[0] ? kRadPerDeg * f.gravity_tilt_deg : 0.0};
  world.load = {ToWindow(f.load_s), f.load_s[1] > f.load_s[0] ? f.load_mass : 0.0};
}

}  // namespace fovea::sim
