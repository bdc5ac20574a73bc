// SPDX-License-Identifier: Apache-2.0
// What the camera sees of the arm: the solids that the simulator draws. They are larger than the capsules of
// the servo's model in some places, such as the housings of an elbow, and a target behind one of them is not
// seen.
#pragma once

#include <memory>
#include <vector>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/robots/robot.hpp"

namespace fovea::atlas {

class DrawnArm {
 public:
  // InputError: the program was built without the simulator.
  explicit DrawnArm(const robots::Robot& robot);

  // Whether a solid lies between the camera's centre `p_BC` and one of `points_B`, with the arm at `q`. Links
  // that move with the camera are left out: it is mounted so that it looks past them.
  [[nodiscard]] bool Hides(const model::VecN& q, const model::Vec3& p_BC,
                           const std::vector<model::Vec3>& points_B) const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace fovea::atlas
