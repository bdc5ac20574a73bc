// What this program was built from. Written by the build (tools/cmake/WriteBuildInfo.cmake).
#pragma once

namespace fovea {

extern const char* const kGitRevision;       // git describe --always --dirty; "" outside a checkout
extern const char* const kServoLibraryHash;  // SHA-256 of the servo library that is linked in
extern const char* const kVersion;
extern const char* const kCompiler;  // name and version
extern const char* const kFlags;     // that the servo's libraries were compiled with

}  // namespace fovea
