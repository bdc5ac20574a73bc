// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/load_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>

#include "firmware/host/config/input_error.hpp"

namespace fovea::config {

void AddLoadKeys(LoadSettings& settings, KeyTable& keys) {
  keys.Number("arm.load_mass", settings.mass, 0.0, 100.0, "kg",
              "mass that the end effector carries, with the camera; robot and servo know of it");
  keys.Numbers("arm.load_com", settings.com, 3, 3, -2.0, 2.0, "m", "the load's centre of mass in E");
  keys.Numbers("arm.load_inertia", settings.inertia, 3, 6, -100.0, 100.0, "kg m^2",
               "its inertia about its centre of mass, in axes of E: xx, yy, zz, then xy, xz, yz if not 0");
}

model::Load MakeLoad(const LoadSettings& settings) {
  const std::vector<double>& I = settings.inertia;
  if (I.size() != 3 && I.size() != 6) {
    throw InputError(fmt::format("arm.load_inertia has {} entries: 3 or 6 are allowed", I.size()));
  }
  model::Load load;
  load.mass = settings.mass;
  load.p_ECom = {settings.com[0], settings.com[1], settings.com[2]};
  load.I_Com_E.diagonal() << I[0], I[1], I[2];
  if (I.size() == 6) {
    load.I_Com_E(0, 1) = load.I_Com_E(1, 0) = I[3];
    load.I_Com_E(0, 2) = load.I_Com_E(2, 0) = I[4];
    load.I_Com_E(1, 2) = load.I_Com_E(2, 1) = I[5];
  }
  const Eigen::SelfAdjointEigenSolver<model::Mat3> solver(load.I_Com_E, Eigen::EigenvaluesOnly);
  const model::Vec3& moments = solver.eigenvalues();  // ascending
  const double least = -1e-12;                        // slack for rounding: a point mass has moments of 0
  if (!(moments[0] >= least && moments[0] + moments[1] >= moments[2] * (1.0 - 1e-6) + least)) {
    throw InputError(
        fmt::format("arm.load_inertia = [{}] is not allowed: no body has principal moments "
                    "{:.4g}, {:.4g}, {:.4g} (each at most the sum of the others)",
                    fmt::join(I, ", "), moments[0], moments[1], moments[2]));
  }
  if (load.mass == 0.0) {
    return {};
  }
  return load;
}

}  // namespace fovea::config
