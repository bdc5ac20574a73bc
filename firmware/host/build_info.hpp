// SPDX-License-Identifier: Apache-2.0
// Build information of this program. The build generates the values (tools/cmake/WriteBuildInfo.cmake).
#pragma once

#include <map>
#include <string>

namespace fovea {

extern const char* const kGitRevision;       // git describe --always --dirty; "" outside a checkout
extern const char* const kServoLibraryHash;  // SHA-256 of the linked servo library
extern const char* const kLinkLibraryHash;   // SHA-256 of the linked library that encodes the servo's state
extern const char* const kVersion;
extern const char* const kCompiler;  // name and version
extern const char* const kFlags;     // compiler flags of the servo's libraries

// The same values by name, as a log stores them.
inline std::map<std::string, std::string> BuildEntries() {
  return {{"version", kVersion},
          {"git", kGitRevision},
          {"servo library", kServoLibraryHash},
          {"link library", kLinkLibraryHash},
          {"compiler", kCompiler},
          {"flags", kFlags}};
}

}  // namespace fovea
