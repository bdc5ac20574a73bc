// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/shorten_path.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::planning {
namespace {

constexpr double kTries = 0.03;    // for each unit of work
constexpr double kShorter = 0.98;  // a replacement counts if its length is below this share
constexpr double kApart = 0.3;     // places nearer than this along the path are not joined [rad]
constexpr int kMostSteps = 60;     // of a motion that keeps the target in the picture

// A place on the path: after corner `corner`, at `share` of the way to the next.
struct Place {
  std::size_t corner = 0;
  model::VecN q;
};

Place PlaceAt(const PostureSpace& space, const Polyline& path, double along) noexcept {
  Place place{0, path.front()};
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double length = space.Distance(path[i], path[i + 1]);
    place.corner = i;
    if (along <= length) {
      place.q = path[i] + (length > 0.0 ? along / length : 0.0) * (path[i + 1] - path[i]);
      return place;
    }
    along -= length;
  }
  place.q = path.back();
  return place;
}

}  // namespace

double LengthOf(const PostureSpace& space, const Polyline& path) noexcept {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    length += space.Distance(path[i], path[i + 1]);
  }
  return length;
}

PathShortener::PathShortener() { part_.reserve(kMostCorners); }

// Puts a motion from `from` to `to` with the target in the picture, without its ends, into part_. False if
// barred or not shorter than `most`.
bool PathShortener::GoInView(const PostureSpace& space, const model::VecN& from, const model::VecN& to,
                             double most, Work& work) noexcept {
  part_.clear();
  model::VecN at = from;
  double length = 0.0;
  for (int step = 0; step < kMostSteps; ++step) {
    model::VecN next;
    const Progress progress = StepTowards(space, at, to, work, next);
    length += space.Distance(at, next);
    if (progress == Progress::kBarred || length + space.Distance(next, to) >= most) {
      return false;
    }
    if (progress == Progress::kThere) {
      return true;
    }
    part_.push_back(next);
    at = next;
  }
  return false;
}

void PathShortener::Shorten(const PostureSpace& space, int most_work, Work& work, Draws& draws,
                            Polyline& path) noexcept {
  const std::int64_t keep = std::max<std::int64_t>(work.left() - most_work, 0);
  for (int attempt = 0; attempt < kTries * most_work && work.left() > keep && path.size() > 2; ++attempt) {
    const double length = LengthOf(space, path);
    double low = attempt == 0 ? 0.0 : draws.Uniform(0.0, length);
    double high = attempt == 0 ? length : draws.Uniform(0.0, length);
    if (low > high) {
      std::swap(low, high);
    }
    const Place from = PlaceAt(space, path, low);
    const Place to = PlaceAt(space, path, high);
    if (high - low < kApart || from.corner == to.corner) {
      continue;
    }
    const double most = kShorter * (high - low);
    part_.clear();
    const bool is_straight = space.Distance(from.q, to.q) < most && IsEdgeFree(space, from.q, to.q, work);
    if (!is_straight && !GoInView(space, from.q, to.q, most, work)) {
      continue;
    }
    // The corners between the two places give way to the part with its two ends.
    const std::size_t removed = to.corner - from.corner;
    if (path.size() - removed + part_.size() + 2 > kMostCorners) {
      continue;
    }
    part_.insert(part_.begin(), from.q);
    part_.push_back(to.q);
    const auto first = path.begin() + static_cast<std::ptrdiff_t>(from.corner + 1);
    path.insert(path.erase(first, first + static_cast<std::ptrdiff_t>(removed)), part_.begin(), part_.end());
  }
}

void PathShortener::Resample(const PostureSpace& space, int points, Polyline& path) noexcept {
  const double length = LengthOf(space, path);
  part_.clear();
  for (int i = 0; i + 1 < points; ++i) {
    part_.push_back(PlaceAt(space, path, length * i / (points - 1)).q);
  }
  part_.push_back(path.back());
  path.assign(part_.begin(), part_.end());
}

void Straighten(const PostureSpace& space, int sweeps, Work& work, Polyline& path) noexcept {
  Posture posture;
  for (int sweep = 0; sweep < sweeps && work.IsLeft(); ++sweep) {
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      model::VecN q = 0.5 * (path[i - 1] + path[i + 1]);
      if (space.PullIntoView(q, work, posture) && space.Judge(posture).is_free &&
          space.Distance(path[i - 1], q) + space.Distance(q, path[i + 1]) <=
              space.Distance(path[i - 1], path[i]) + space.Distance(path[i], path[i + 1])) {
        path[i] = q;
      }
    }
  }
}

}  // namespace fovea::planning
