# SPDX-License-Identifier: Apache-2.0
# Uses ccache if it is installed. Then nothing is compiled twice, even after `rm -r build` or in another checkout of the same
# sources: ccache makes paths below the root relative to the build folder. Comments count:
# GCC takes a header for another one than that in a precompiled header if only a comment differs, and '#pragma once' fails.
find_program(FOVEA_CCACHE ccache)
mark_as_advanced(FOVEA_CCACHE)
if(FOVEA_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
      CCACHE_COMMENTS=1 CCACHE_SLOPPINESS=pch_defines,time_macros
      ${CMAKE_CURRENT_LIST_DIR}/ccache_compile ${FOVEA_CCACHE})
endif()
