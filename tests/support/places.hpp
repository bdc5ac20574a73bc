// Where the tests find the tree's own files. Functions, not macros: no test's object depends on where the
// tree lies.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::test {

std::filesystem::path SourceRoot();
std::string RobotsFolder();

}  // namespace fovea::test
