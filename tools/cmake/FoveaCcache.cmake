# Where ccache is installed, what was compiled once is not compiled again: not after `rm -r build`, and not in another
# checkout of the same sources. (Paths below the root count as relative to the build folder.)
find_program(FOVEA_CCACHE ccache)
mark_as_advanced(FOVEA_CCACHE)
if(FOVEA_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${FOVEA_CCACHE})
endif()
