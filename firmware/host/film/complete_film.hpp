// The end of a film beside a run: what goes wrong with it costs nothing but the film.
#pragma once

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace fovea::film {

// Calls `complete`, which may throw. Whether the film of that name is there; where it is not, one line that
// says why is added to `errors`, for the summary of the run.
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
