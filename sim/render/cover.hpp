// SPDX-License-Identifier: Apache-2.0
// Finds what a horizontal surface hides. If the whole picture shows only a table and the things on it, floor
// and walls need not be drawn; the picture is the same.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "sim/render/bench.hpp"
#include "sim/render/pinhole.hpp"

namespace fovea::sim {

using Box = Eigen::AlignedBox3f;  // in B

// The bounding box of a mesh.
Box FindBox(const Mesh& mesh);

// A box that contains everything visible, if every ray of the picture meets the upper side of `plane` at
// least 20 mm inside its edges; otherwise none. The box reaches 30 mm below the plane, to include its slab.
std::optional<Box> SeenOver(const TexturedPlane& plane, const Pinhole& pinhole,
                            const Eigen::Isometry3f& X_BC);

}  // namespace fovea::sim
