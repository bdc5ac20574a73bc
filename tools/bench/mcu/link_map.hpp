// How many bytes of an image each module takes, from the map that the linker wrote beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace fovea::bench {

struct ModuleBytes {
  std::uint64_t flash = 0;  // code, constants, and what variables begin as
  std::uint64_t ram = 0;    // variables and stacks
};

struct LinkMap {
  std::map<std::string, ModuleBytes> modules;
  ModuleBytes total;  // of the output sections: what the modules must add up to
};

// std::runtime_error when it is no map of GNU ld's.
LinkMap ReadLinkMap(const std::filesystem::path& file);

}  // namespace fovea::bench
