// SPDX-License-Identifier: Apache-2.0
// Postures with the target where it has to be in the camera: descents (Gauss-Newton) from one posture, from
// near it and from anywhere, as far as they end in a posture that is clear of everything.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "tools/fovea/atlas/checks.hpp"
#include "tools/fovea/atlas/uniform.hpp"

namespace fovea::atlas {

class GoalPostures {
 public:
  // How near postures may come to what the arm must keep off: the ends of its joints' ranges, solids, itself.
  enum class Bounds : std::uint8_t {
    kOfDraws,  // with room: of drawn starts and their goals
    kOfServo,  // those that the servo's guard keeps
  };
  explicit GoalPostures(const Scene& scene, Bounds bounds = Bounds::kOfDraws);

  struct Descents {
    int near = 16;  // from postures within 0.5 rad
    int far = 24;   // from anywhere
  };
  // With the target at its goal, whose pose in B is `X_BO`: one for each descent that succeeds.
  [[nodiscard]] std::vector<model::VecN> Find(const model::VecN& q, const model::Pose& X_BO,
                                              const Descents& descents, std::mt19937_64& engine) const;

  // A posture with the camera at `X_BC`, within the joints' ranges; none if no descent finds one that
  // `is_allowed`.
  [[nodiscard]] std::optional<model::VecN> WithCameraAt(
      const model::Pose& X_BC, const std::function<bool(const model::VecN& q)>& is_allowed) const;

  // Uniform in the joints' ranges, to 1e-4 rad. Draws keep 5 degrees off each end, the servo
  // safety.joint_position_margin.
  [[nodiscard]] model::VecN DrawPosture(std::mt19937_64& engine) const;
  // The goal's orientation. If several look alike, the nearest one.
  [[nodiscard]] model::Mat3 NearestGoal(const model::Mat3& R_CO) const;
  // If the target is not completely in the picture: a step that moves its centre a third of the way to the
  // picture's centre; else `q`.
  [[nodiscard]] model::VecN PulledIntoView(const model::VecN& q, const model::Pose& X_BO) const;

  [[nodiscard]] const StartChecks& checks() const { return checks_; }
  [[nodiscard]] const model::VecN& least() const { return q_least_; }
  [[nodiscard]] const model::VecN& most() const { return q_most_; }

 private:
  // How far the target is from where it should be [m, rad]: its position, then its orientation if that
  // counts.
  using Off = std::function<model::Vec6(const model::Pose& X_CO)>;
  [[nodiscard]] std::optional<model::VecN> Descend(const model::VecN& q_start, const model::Pose& X_BO,
                                                   int rows, const Off& off) const;
  [[nodiscard]] std::optional<model::VecN> DescendToGoal(const model::VecN& q, const model::Pose& X_BO) const;

  StartChecks checks_;
  Bounds bounds_;
  model::VecN q_least_;  // the joints' ranges, less the margin
  model::VecN q_most_;
};

}  // namespace fovea::atlas
