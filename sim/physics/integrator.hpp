// SPDX-License-Identifier: Apache-2.0
// How the physics steps.
#pragma once

namespace fovea::sim {

enum class Integrator {
  kSemiImplicitEuler,  // Bullet's default, one evaluation per step
  kRungeKutta4,        // four evaluations per step; keeps energy 7 orders better
};

}  // namespace fovea::sim
