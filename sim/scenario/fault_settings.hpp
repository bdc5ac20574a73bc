// [faults]: what goes wrong in a run, when, and how badly; by script, and by run.seed where it is random.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/host/config/key_table.hpp"
#include "sim/faults/bench_faults.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/faulty_detector.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/faults/picture_faults.hpp"
#include "sim/faults/stalling_clock.hpp"

namespace fovea::sim {

// What each part of the simulator is told of its faults; sim/faults has their keys beside them.
struct FaultSettings {
  BenchFaults bench;
  FrameFaults frames;
  PictureFaults picture;
  DetectorFaults detector;
  ArmFaults arm;
  StallFault stall;
  TimeWindow nothing;  // nothing goes wrong
};

// The same faults by another seed of what is random in them.
template <class Faults>
Faults Seeded(Faults faults, std::uint64_t seed) {
  faults.seed = seed;
  return faults;
}

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

}  // namespace fovea::sim
