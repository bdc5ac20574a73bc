// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/truth_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fovea::sim {
namespace {

constexpr std::size_t kMostEntries = 32;
constexpr double kMostFactor = 100.0;
constexpr double kMostScaleSigma = 0.33;  // three of them leave a factor above 0

constexpr std::array<QuantityInfo, kNumQuantities> kQuantities{{
    {"camera.mount_xyz", "m", -1.0, 1.0, "place of the camera on the hand"},
    {"camera.mount_turn_deg", "deg", -180.0, 180.0,
     "turn of the camera against its believed mount: a rotation vector in axes of the believed camera"},
    {"camera.f_px", "px", 1.0, 1e6, "focal length along u; that along v changes by the same factor"},
    {"camera.aspect", "", 0.5, 2.0, "focal length along v over that along u"},
    {"camera.c_px", "px", -1e5, 1e5, "principal point: c_u, c_v"},
    {"camera.lens", "", -1e3, 1e3, "lens: k1, k2, p1, p2, k3"},
    {"camera.latency_ms", "ms", 0.0, 500.0,
     "latency; the servo subtracts the believed latency from a picture's arrival"},
    {"camera.latency_jitter_ms", "ms", 0.0, 100.0, "standard deviation of each frame's latency; believed: 0"},
    {"camera.clock_drift_ppm", "ppm", -1e3, 1e3, "how much faster the clock of the stamps runs; believed: 0"},
    {"arm.link_mass", "kg", 1e-6, 1e4, "masses of the moving links, without the load"},
    {"arm.link_com_shift", "m", -1.0, 1.0,
     "shift of each moving link's centre of mass, x, y, z for each, in axes of the link; believed: 0"},
    {"arm.viscous", "Nm s/rad", 0.0, 1e6, "viscous friction, one per joint"},
    {"arm.coulomb", "Nm", 0.0, 1e6, "Coulomb friction, one per joint"},
    {"arm.load_mass", "kg", 0.0, 100.0, "mass of the load; its inertia changes by the same factor"},
    {"arm.load_com", "m", -2.0, 2.0, "the load's centre of mass"},
    {"arm.encoder_zero", "rad", -0.5, 0.5, "reading of each joint's encoder at angle 0; believed: 0"},
    {"arm.torque_scale", "", 0.1, 3.0, "delivered share of each joint's commanded torque; believed: 1"},
    {"arm.torque_bias", "Nm", -1e3, 1e3, "delivered torque of each joint at command 0; believed: 0"},
    {"arm.base_tilt_deg", "deg", -45.0, 45.0, "tilt of the base about its x and y axes; believed: 0"},
    {"target.size_scale", "", 0.1, 10.0, "true size of the target over the believed one; believed: 1"},
    {"arm.rotor_inertia", "kg m^2", 0.0, 1e3, "inertias of the rotors, seen at the joints, one per joint"},
    {"camera.row_time_us", "us", 0.0, 1e3, "rolling shutter: time from one row to the next"},
}};
struct Form {
  const char* name;
  const char* meaning;
};
constexpr std::array<Form, 6> kForms{{
    {"scale", "the believed one times this"},
    {"scale_sigma", "the believed one times a normal random factor about 1, of this standard deviation"},
    {"scale_range", "the believed one times a uniform random factor, from the first to the second"},
    {"offset", "the believed one plus this"},
    {"sigma", "the believed one plus a normal random number about 0, of this standard deviation"},
    {"range", "the believed one plus a uniform random number, from the first to the second"},
}};
static_assert(static_cast<std::size_t>(Quantity::kRowTime) + 1 == kNumQuantities);

}  // namespace

const QuantityInfo& InfoOf(Quantity quantity) { return kQuantities.at(static_cast<std::size_t>(quantity)); }

bool TruthSettings::IsAny() const {
  return std::any_of(of.begin(), of.end(), [](const Deviation& deviation) { return deviation.IsAny(); });
}

void AddTruthKeys(TruthSettings& settings, config::KeyTable& keys) {
  for (std::size_t i = 0; i < kNumQuantities; ++i) {
    const QuantityInfo& info = kQuantities.at(i);
    Deviation& d = settings.of.at(i);
    const std::string key = std::string("truth.") + info.key;
    const double most = info.high - info.low;
    keys.OneOrMore(key, d.value, kMostEntries, info.low, info.high, info.unit, info.meaning);
    keys.OneOrMore(key + ".scale", d.scale, kMostEntries, 0.0, kMostFactor, "", "");
    keys.OneOrMore(key + ".scale_sigma", d.scale_sigma, kMostEntries, 0.0, kMostScaleSigma, "", "");
    keys.Numbers(key + ".scale_range", d.scale_range, 2, 2, 0.0, kMostFactor, "", "");
    keys.OneOrMore(key + ".offset", d.offset, kMostEntries, -most, most, info.unit, "");
    keys.OneOrMore(key + ".sigma", d.sigma, kMostEntries, 0.0, most, info.unit, "");
    keys.Numbers(key + ".range", d.range, 2, 2, -most, most, info.unit, "");
  }
}

std::string TruthFormsAsText() {
  std::string text =
      "A key of [truth] takes the true value, or differences: `camera.mount_xyz = { sigma = 0.005 }` in "
      "[truth], or `--set truth.camera.mount_xyz.sigma=0.005`. The true value is then\n";
  for (const Form& form : kForms) {
    text += fmt::format("  {:<12} {}\n", form.name, form.meaning);
  }
  return text;
}

std::string TruthFormsAsMarkdown() {
  std::string text =
      "What is true of arm, camera and target, where it is not what the servo believes. Without such a key, "
      "what the servo believes is true. A key takes the true value, or an inline table of differences, for "
      "example `camera.mount_xyz = { sigma = 0.005 }` in [truth], or `--set "
      "truth.camera.mount_xyz.sigma=0.005`:\n\n| form | true value |\n|---|---|\n";
  for (const Form& form : kForms) {
    text += fmt::format("| `{}` | {} |\n", form.name, form.meaning);
  }
  return text +
         "\nA number is for all entries of a list; a list has a number for each. Several forms may be given. "
         "Random numbers follow from `run.seed`; normal ones stay within three standard deviations. "
         "`summary.json` has the values that were drawn.\n";
}

}  // namespace fovea::sim
