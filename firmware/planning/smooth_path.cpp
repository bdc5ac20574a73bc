// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/smooth_path.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::planning {
namespace {

// The piece that contains `u`: its corner, 0 for the first half edge and the last corner for the last one,
// and how far along.
struct Piece {
  std::size_t corner;
  double share;
};

Piece PieceAt(double u, double end) noexcept {
  if (u <= 0.5) {
    return {0, u};
  }
  if (u >= end - 0.5) {
    return {static_cast<std::size_t>(end), u - (end - 0.5)};
  }
  const double corner = std::floor(u + 0.5);
  return {static_cast<std::size_t>(corner), u + 0.5 - corner};
}

}  // namespace

model::VecN SmoothPath::At(double u) const noexcept {
  const Piece piece = PieceAt(std::clamp(u, 0.0, End()), End());
  if (piece.corner == 0) {
    return corners_.front() + piece.share * Edge(0);
  }
  const std::size_t last = corners_.size() - 1;
  if (piece.corner == last) {
    return corners_.back() - (0.5 - piece.share) * Edge(last - 1);
  }
  const model::VecN before = Edge(piece.corner - 1);
  const model::VecN bend = Edge(piece.corner) - before;
  return corners_[piece.corner] + (piece.share - 0.5) * before + 0.5 * piece.share * piece.share * bend;
}

model::VecN SmoothPath::Slope(double u) const noexcept {
  const Piece piece = PieceAt(std::clamp(u, 0.0, End()), End());
  if (piece.corner == 0) {
    return Edge(0);
  }
  if (piece.corner == corners_.size() - 1) {
    return Edge(piece.corner - 1);
  }
  return (1.0 - piece.share) * Edge(piece.corner - 1) + piece.share * Edge(piece.corner);
}

model::VecN SmoothPath::Bend(double u) const noexcept {
  const Piece piece = PieceAt(u, End());
  if (piece.corner == 0 || piece.corner == corners_.size() - 1) {
    return model::VecN::Zero(corners_.front().size());
  }
  return Edge(piece.corner) - Edge(piece.corner - 1);
}

}  // namespace fovea::planning
