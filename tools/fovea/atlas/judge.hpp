// SPDX-License-Identifier: Apache-2.0
// Judges the starts from which a run failed: does a way to the goal exist? It searches for minutes, by itself
// (way.hpp), so that a servo is not excused by its own planner. A way that it finds exists. When it finds
// none, a narrow one may still exist.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/fovea/atlas/sampler.hpp"

namespace fovea::atlas {

struct Judgement {
  bool has_way = false;
  double length = 0.0;  // of the found way [rad]
  int draws = 0;        // random postures in all searches
  int goals = 0;        // different goal postures
};

// E.g. "a way of 5.2 rad exists"; "no way found in 240000 draws from 31 goal postures".
std::string InWords(const Judgement& judgement);

// How long the judge searches.
struct JudgeEffort {
  int descents = 300;  // that look for goal postures, besides those near the start
  int searches = 4;    // each from the beginning: a search that begins badly may stay bad
  int draws = 60000;   // of each search
};

// Depends on nothing but its arguments. Several threads may call it.
Judgement JudgeStart(const Scene& scene, const Start& start, const JudgeEffort& effort = {});

// Judges all of `starts`, `jobs` at a time. `on_judged` is called in one thread at a time, with the place in
// `starts`, in the order in which the judgements end.
void JudgeStarts(const Scene& scene, const std::vector<Start>& starts, int jobs,
                 const std::function<void(std::size_t, const Judgement&)>& on_judged);

}  // namespace fovea::atlas
