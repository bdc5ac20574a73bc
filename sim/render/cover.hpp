// What a level surface hides. Where the whole picture shows nothing but a table and what stands on it,
// neither the floor nor walls need be drawn; the picture is the same.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "sim/render/bench.hpp"
#include "sim/render/pinhole.hpp"

namespace fovea::sim {

using Box = Eigen::AlignedBox3f;  // in B

// Holds all vertices of a mesh.
Box FindBox(const Mesh& mesh);

// A box that holds all that can be seen of the bench, and of things before it, when every ray of the picture
// meets the upper side of `plane`, 20 mm inside its edges or more; nothing when one does not. It
// reaches 30 mm below the plane, to what that lies on.
std::optional<Box> SeenOver(const TexturedPlane& plane, const Pinhole& pinhole,
                            const Eigen::Isometry3f& X_BC);

}  // namespace fovea::sim
