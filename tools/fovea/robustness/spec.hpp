// SPDX-License-Identifier: Apache-2.0
// Uncertainties: keys of a scenario's section [truth], which say what is not as the servo believes.
//
// Only the simulator knows all keys and what they allow. Here they are read, scaled and passed on.
#pragma once

#include <string>
#include <vector>

namespace fovea::robustness {

// One key, such as truth.camera.mount_xyz.sigma.
struct Uncertainty {
  std::string quantity;  // "camera.mount_xyz"
  std::string form;      // "sigma"; "" if the key is the true value itself
  std::vector<double> numbers;
  bool is_list = false;  // as it was written
};

struct Spec {
  std::string name;  // as given; "--set" without one
  std::vector<Uncertainty> list;
};

// True if this "key=value" is of section [truth].
bool IsTruth(const std::string& assignment);

// Names of the shipped specifications, in alphabetical order.
std::vector<std::string> ShippedSpecs();

// Reads a shipped specification by name or a .toml by path ("": none), then applies `assignments`
// ("key=value") of [truth] in order. InputError: there is no such file, it has a key of another section, a
// value that is no number, or nothing at all.
Spec LoadSpec(const std::string& name_or_path, const std::vector<std::string>& assignments);

// The specification with every difference `size` times as large, as values of fovea-sim's --set. A factor's
// distance from 1 counts as its size. InputError: a true value given by itself cannot be scaled.
std::vector<std::string> Scaled(const Spec& spec, double size);

// "truth.KEY=NUMBER" or "truth.KEY=[...]".
std::string TruthAssignment(const std::string& key, const std::vector<double>& numbers, bool as_list);

}  // namespace fovea::robustness
