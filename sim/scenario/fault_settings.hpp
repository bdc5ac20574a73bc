// SPDX-License-Identifier: Apache-2.0
// [faults]: the faults of a run with their times and sizes. Random faults depend on run.seed.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/host/config/key_table.hpp"
#include "sim/faults/bench_faults.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/faulty_detector.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/faults/picture_faults.hpp"
#include "sim/faults/planner_faults.hpp"
#include "sim/faults/stalling_clock.hpp"

namespace fovea::sim {

// The faults of each part of the simulator. Their keys are beside the structs, in sim/faults.
struct FaultSettings {
  BenchFaults bench;
  FrameFaults frames;
  PictureFaults picture;
  DetectorFaults detector;
  ArmFaults arm;
  StallFault stall;
  TimeWindow nothing;  // no fault: a reference run
  PlannerFaults planner;
};

// All lists, in the order of the keys.
template <class Visitor, Struct<FaultSettings> Settings>
void Fields(Visitor& v, Settings& f) {
  Fields(v, f.bench);
  Fields(v, f.frames);
  Fields(v, f.picture);
  Fields(v, f.detector);
  Fields(v, f.arm);
  Fields(v, f.stall);
  v.Window({"nothing", "s",
            "no fault: a reference run; summary.json lists what the servo noticed, for comparison"},
           f.nothing);
  Fields(v, f.planner);
}

// The same faults with another seed.
template <class Faults>
Faults Seeded(Faults faults, std::uint64_t seed) {
  faults.seed = seed;
  return faults;
}

// A fault of a run, by the name of its keys.
struct FaultWindow {
  const char* name;
  double from_s = 0.0;
  double to_s = 0.0;
};

// The faults of a run, in the order of the keys; includes `nothing`.
std::vector<FaultWindow> FaultsOf(const FaultSettings& faults);

void AddFaultKeys(FaultSettings& faults, config::KeyTable& keys);

// InputError: a window ends before it begins, the arm has no such joint, or a size is not above 0.
void CheckFaults(const FaultSettings& faults, int num_joints);

// InputError: a fault that acts between arm, detector and servo is set. `serve` has only the bench's faults.
void CheckServedFaults(const FaultSettings& faults);

}  // namespace fovea::sim
