// SPDX-License-Identifier: Apache-2.0
// The bytes of an image that each module takes, from the linker's map file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace fovea::bench {

struct ModuleBytes {
  std::uint64_t flash = 0;  // code, constants, and initial values of variables
  std::uint64_t ram = 0;    // variables and stacks
};

struct LinkMap {
  std::map<std::string, ModuleBytes> modules;
  ModuleBytes total;  // of the output sections; the modules must add up to it
};

// std::runtime_error when `file` is not a map of GNU ld.
LinkMap ReadLinkMap(const std::filesystem::path& file);

}  // namespace fovea::bench
