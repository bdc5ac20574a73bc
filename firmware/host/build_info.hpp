// What this program was built from. Written by the build (tools/cmake/WriteBuildInfo.cmake).
#pragma once

#include <map>
#include <string>

namespace fovea {

extern const char* const kGitRevision;       // git describe --always --dirty; "" outside a checkout
extern const char* const kServoLibraryHash;  // SHA-256 of the servo library that is linked in
extern const char* const kLinkLibraryHash;   // and of the one that keeps its state
extern const char* const kVersion;
extern const char* const kCompiler;  // name and version
extern const char* const kFlags;     // that the servo's libraries were compiled with

// The same by name, as a log has it.
inline std::map<std::string, std::string> BuildEntries() {
  return {{"version", kVersion},
          {"git", kGitRevision},
          {"servo library", kServoLibraryHash},
          {"link library", kLinkLibraryHash},
          {"compiler", kCompiler},
          {"flags", kFlags}};
}

}  // namespace fovea
