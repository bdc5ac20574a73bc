// SPDX-License-Identifier: Apache-2.0
#include "tests/support/places.hpp"

namespace fovea::test {

std::filesystem::path SourceRoot() { return FOVEA_SOURCE_ROOT; }
std::string RobotsFolder() { return (SourceRoot() / "firmware/host/robots/share").string(); }

}  // namespace fovea::test
