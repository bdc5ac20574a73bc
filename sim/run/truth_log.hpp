// What only a simulated run's log has: what the run is about, by its scenario, and what is true.
#pragma once

#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/run/run_book.hpp"
#include "foxglove/image.pb.h"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

run::RunFacts FactsOf(const RunDescription& about);

// From the thread that advances the world.
void LogTruth(const RunDescription& about, const Truth& truth, log::RunLog& log);
void LogTheory(const TheorySample& sample, log::RunLog& log);

// The target's true outline on a picture; `X_CO`: where it really was.
foxglove::ImageAnnotations TruthOnPicture(const RunDescription& about, const model::Pose& X_CO);

}  // namespace fovea::sim
