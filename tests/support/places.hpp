// SPDX-License-Identifier: Apache-2.0
// Paths of the tree's own files. Functions, not macros: no test's object code depends on the tree's path.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::test {

std::filesystem::path SourceRoot();
std::string RobotsFolder();

}  // namespace fovea::test
