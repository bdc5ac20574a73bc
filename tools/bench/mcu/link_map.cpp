// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/mcu/link_map.hpp"

#include <array>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace fovea::bench {
namespace {

// {part of a section's name or file, its module}; the first match counts.
constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kModules{{
    {"panda_data", "arm table"},
    {"LoadPanda", "arm table"},
    {"libfovea_servo.a", "servo"},
    {"libfovea_features.a", "features"},
    {"libfovea_model.a", "model"},
    {"libfovea_link.a", "link"},
    {"libfovea_hal.a", "hal"},
    {"drivers/cortex_m7", "board driver"},
    {"targets/cortex_m7", "program"},
    {"libc.a", "newlib"},
    {"libgcc.a", "libgcc"},
}};

std::string ModuleOf(const std::string& section, const std::string& file) {
  for (const auto& [part, module] : kModules) {
    if (section.find(part) != std::string::npos || file.find(part) != std::string::npos) {
      return std::string(module);
    }
  }
  return file.empty() ? "alignment" : "other";
}

// The memories that an output section occupies: none for sections that are not in the image.
struct Place {
  bool flash = false;
  bool ram = false;
};

Place PlaceOf(const std::string& section) {
  if (section == ".text" || section == ".ARM.exidx") {
    return {true, false};
  }
  if (section == ".data") {
    return {true, true};
  }
  return {false, section == ".bss" || section == ".stack"};
}

void Add(Place place, std::uint64_t size, ModuleBytes& bytes) {
  bytes.flash += place.flash ? size : 0;
  bytes.ram += place.ram ? size : 0;
}

bool IsHex(const std::string& word) { return word.starts_with("0x"); }

}  // namespace

LinkMap ReadLinkMap(const std::filesystem::path& path) {
  std::ifstream stream(path);
  LinkMap map;
  bool in_sections = false;
  Place place;
  std::string output;
  bool counted = true;  // whether the size of the output section was read
  std::string section;
  for (std::string line; std::getline(stream, line);) {
    in_sections = in_sections || line == "Linker script and memory map";
    if (!in_sections || line.empty()) {
      continue;
    }
    std::istringstream in(line);
    std::vector<std::string> words;
    for (std::string word; in >> word;) {
      words.push_back(word);
    }
    const bool new_output = line.front() == '.';
    const bool new_section = line.starts_with(" .") || line.starts_with(" *fill*");
    if (words.empty()) {
      continue;
    }
    if (new_output) {
      output = words.front();
      place = PlaceOf(output);
      section.clear();
      counted = false;
      words.erase(words.begin());
    } else if (new_section) {
      section = words.front();
      words.erase(words.begin());
    }
    // An address and a size follow on the name's line, or on the next one if the name is long.
    if (words.size() < 2 || !IsHex(words[0]) || !IsHex(words[1])) {
      continue;
    }
    const std::uint64_t size = std::stoull(words[1], nullptr, 16);
    if (!section.empty()) {
      Add(place, size,
          map.modules[output == ".stack" ? "stacks" : ModuleOf(section, words.size() > 2 ? words[2] : "")]);
      section.clear();  // the symbols that follow have an address and a name, but no size
      counted = true;
    } else if (!counted) {
      Add(place, size, map.total);
      counted = true;
    }
  }
  if (map.total.flash == 0) {
    throw std::runtime_error(path.string() + ": not found, or not a linker map");
  }
  std::erase_if(map.modules,
                [](const auto& module) { return module.second.flash == 0 && module.second.ram == 0; });
  return map;
}

}  // namespace fovea::bench
