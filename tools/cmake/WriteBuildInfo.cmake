# SPDX-License-Identifier: Apache-2.0
# The build runs this script. It writes OUTPUT from the checkout at SOURCE and the libraries SERVO and LINK. It does not touch
# OUTPUT when nothing changed.
find_package(Git QUIET)
set(revision "")
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} describe --always --dirty
                  OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
file(SHA256 ${SERVO} servo_hash)
file(SHA256 ${LINK} link_hash)
set(content "// Written by tools/cmake/WriteBuildInfo.cmake.
#include \"firmware/host/build_info.hpp\"

namespace fovea {
const char* const kGitRevision = \"${revision}\";
const char* const kServoLibraryHash = \"${servo_hash}\";
const char* const kLinkLibraryHash = \"${link_hash}\";
const char* const kVersion = \"${VERSION}\";
const char* const kCompiler = \"${COMPILER}\";
const char* const kFlags = \"${FLAGS}\";
}  // namespace fovea
")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT "${before}" STREQUAL "${content}")
  file(WRITE ${OUTPUT} "${content}")
endif()
