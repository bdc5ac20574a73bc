// [faults]: what goes wrong in a run, when, and how badly; by script, and by run.seed where it is random.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/host/config/key_table.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/faulty_detector.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/faults/picture_faults.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// Each window is [from, to] in seconds of the run; [0, 0] never begins. Joints count from 1.
struct FaultSettings {
  std::vector<double> camera_outage_s{0.0, 0.0};
  std::vector<double> frame_loss_s{0.0, 0.0};
  double frame_loss = 0.5;
  std::vector<double> freeze_s{0.0, 0.0};
  bool freeze_pixels = false;
  std::vector<double> replay_s{0.0, 0.0};
  double replay_delay_s = 1.0;
  std::vector<double> mirror_s{0.0, 0.0};
  std::vector<double> stamp_s{0.0, 0.0};
  double stamp_ms = 8.0;
  std::vector<double> latency_s{0.0, 0.0};
  double latency_ms = 100.0;
  std::vector<double> glare_s{0.0, 0.0};
  std::vector<double> glare_px{320.0, 240.0, 60.0};
  std::vector<double> occluder_s{0.0, 0.0};
  std::vector<double> occluder_px{320.0, 240.0, 60.0, 480.0};
  std::vector<double> wrong_detection_s{0.0, 0.0};
  double wrong_detection = 1.0;
  std::vector<double> wrong_detection_shift{1.0, 0.0, 0.0};
  std::vector<double> nan_detection_s{0.0, 0.0};
  std::vector<double> encoder_stuck_s{0.0, 0.0};
  int encoder_stuck_joint = 1;
  std::vector<double> encoder_noise_s{0.0, 0.0};
  double encoder_noise = 1e-3;
  double velocity_noise = 0.05;
  std::vector<double> encoder_nan_s{0.0, 0.0};
  int encoder_nan_joint = 1;
  std::vector<double> packet_loss_s{0.0, 0.0};
  double packet_loss = 1.0;
  std::vector<double> clock_jump_s{0.0, 0.0};
  double clock_jump_ms = 50.0;
  std::vector<double> deadline_miss_s{0.0, 0.0};
  double deadline_miss = 1.0;
  std::vector<double> torque_loss_s{0.0, 0.0};
  int torque_loss_joint = 1;
  double torque_loss = 1.0;
  std::vector<double> load_s{0.0, 0.0};
  double load_mass = 1.0;
  std::vector<double> gravity_s{0.0, 0.0};
  double gravity_tilt_deg = 5.0;
  std::vector<double> push;  // empty: nothing pushes
  std::vector<double> push_s{0.0, 0.0};
  std::vector<double> nothing_s{0.0, 0.0};
};

// A fault that a run meets, by the name of its keys.
struct FaultWindow {
  const char* name;
  double from_s = 0.0;
  double to_s = 0.0;
};

// Those of a run, in the order of the keys; `nothing` among them.
std::vector<FaultWindow> FaultsOf(const FaultSettings& faults);

void AddFaultKeys(FaultSettings& faults, config::KeyTable& keys);

// InputError when a window ends before it begins, or a joint is none of the arm's.
void CheckFaults(const FaultSettings& faults, int num_joints);

// InputError when a fault is at work that lies between arm, detector and servo: none of the bench's, which is
// all that `serve` has.
void CheckServedFaults(const FaultSettings& faults);

// What each part of the simulator is told of them.
ArmFaults MakeArmFaults(const FaultSettings& faults, std::uint64_t seed);
StallFault MakeStallFault(const FaultSettings& faults, std::uint64_t seed);
FrameFaults MakeFrameFaults(const FaultSettings& faults, std::uint64_t seed);
DetectorFaults MakeDetectorFaults(const FaultSettings& faults, std::uint64_t seed);
PictureFaults MakePictureFaults(const FaultSettings& faults);
void SetBenchFaults(const FaultSettings& faults, WorldConfig& world);

}  // namespace fovea::sim
