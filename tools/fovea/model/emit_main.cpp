// SPDX-License-Identifier: Apache-2.0
// fovea-emit-model ARM: prints the model of a shipped arm as a C++ header, for the build. The output is that
// of `fovea model ARM --emit-cpp`, without the rest of that program.
#include <cstdio>
#include <exception>

#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tools/fovea/model/emit.hpp"

int main(int argc, char** argv) {
  using namespace fovea;
  if (argc != 2) {
    std::fputs("fovea-emit-model: one argument is needed: the name of a shipped arm\n", stderr);
    return 2;
  }
  try {
    const std::string name = argv[1];
    const std::string header =
        EmitModel(robots::LoadRobot(config::ShareFolder() / "robots" / (name + ".toml")));
    return std::fputs(header.c_str(), stdout) < 0 || std::fflush(stdout) != 0 ? 2 : 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fovea-emit-model: %s\n", error.what());
    return 2;
  }
}
