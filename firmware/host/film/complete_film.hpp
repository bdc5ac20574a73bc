// SPDX-License-Identifier: Apache-2.0
// Completes a film at the end of a run. An error costs only the film.
#pragma once

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace fovea::film {

// Calls `complete`, which may throw. True when the film `name` is complete. Otherwise adds one line with the
// reason to `errors`, for the summary of the run.
inline bool CompleteFilm(const std::string& name, const std::function<void()>& complete,
                         std::vector<std::string>& errors) {
  try {
    complete();
    return true;
  } catch (const std::exception& error) {
    errors.push_back(name + ": " + error.what());
    return false;
  }
}

}  // namespace fovea::film
