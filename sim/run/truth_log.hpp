// SPDX-License-Identifier: Apache-2.0
// The parts of the log that only a simulated run has: the facts of its scenario, and the truth.
#pragma once

#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/run/run_book.hpp"
#include "foxglove/image.pb.h"
#include "sim/scenario/run_description.hpp"
#include "sim/theory/run.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

run::RunFacts FactsOf(const RunDescription& about);

// The truth for the log: poses, and the target's error. Call it only if there is a target.
log::TruthSample TruthSampleOf(const RunDescription& about, const Truth& truth);

// The thread that advances the world calls LogTruth and LogTheory.
void LogTruth(const RunDescription& about, const Truth& truth, log::RunLog& log);
void LogTheory(const TheorySample& sample, log::RunLog& log);

// The target's true outline on a picture. `X_CO`: its true pose.
foxglove::ImageAnnotations TruthOnPicture(const RunDescription& about, const model::Pose& X_CO);

}  // namespace fovea::sim
