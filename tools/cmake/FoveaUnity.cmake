# SPDX-License-Identifier: Apache-2.0
# The sources of a folder are compiled together: most of a small source's time is the headers that it shares with its
# neighbours. Their anonymous namespaces become one, so a name must be unique in its folder. Not under the address
# sanitizer: `tools/test asan` compiles each source by itself, so that it shows a source that does not include what it
# uses. Not for a board: its linker map names the sources that take flash and RAM.
option(FOVEA_UNITY "Compile the sources of a folder together" ON)
if(FOVEA_SANITIZE MATCHES "address" OR CMAKE_SYSTEM_NAME STREQUAL Generic)
  set(FOVEA_UNITY OFF)
endif()

# fovea_compile_together(<target> <source>...): sources of the current folder.
function(fovea_compile_together target)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(NOT ARGN OR NOT FOVEA_UNITY OR folder MATCHES "^(tests|tools)/")  # their sources are independent and change one at a time
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # GCC takes the sources for headers, whose anonymous types a class must not have as members.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  string(MAKE_C_IDENTIFIER ${folder} group)
  set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
endfunction()
