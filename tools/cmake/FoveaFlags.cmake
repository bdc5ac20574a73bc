# SPDX-License-Identifier: Apache-2.0
# Compiler flags, in one place. Three sets:
#   fovea_warnings  every target of the project: warnings are errors
#   fovea_bits      PUBLIC on the firmware libraries: flags that decide the bits of a result. All code that uses
#                   their types gets the same bits, on every machine
#   fovea_tick      PRIVATE on the libraries that run inside the 1 kHz tick: no exceptions, no RTTI

include(FoveaInstall)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_SYSTEM_NAME STREQUAL Generic)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

add_library(fovea_warnings INTERFACE)
# Includes are written from the root: "firmware/core/task/servo_task.hpp".
target_include_directories(fovea_warnings INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(fovea_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion -Wold-style-cast
  -Woverloaded-virtual -Werror
  # GCC mistakes the unused capacity of a run-time-sized Eigen matrix for a read of uninitialised memory.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)

add_library(fovea_bits INTERFACE)
# The compiler forms no fused multiply-add. Eigen does not vectorise, so the order of a sum does not depend on the vector
# width. A square root is an instruction, not a call that may set errno.
target_compile_options(fovea_bits INTERFACE -ffp-contract=off -fno-math-errno)
target_compile_definitions(fovea_bits INTERFACE EIGEN_DONT_VECTORIZE EIGEN_DONT_PARALLELIZE)

fovea_install(fovea_bits core)  # code that uses our types needs the same flags

add_library(fovea_tick INTERFACE)
target_compile_options(fovea_tick INTERFACE -fno-exceptions -fno-rtti)

# fovea_optimise_little(<source>...): sources that read a command line. They run once, and the options' templates compile in
# two thirds of the time.
function(fovea_optimise_little)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O1>)
endfunction()

if(FOVEA_SANITIZE)
  # The check of virtual calls (vptr) needs RTTI, which the tick is built without.
  add_compile_options(-fsanitize=${FOVEA_SANITIZE} -fno-sanitize=vptr -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${FOVEA_SANITIZE})
  add_compile_definitions(FOVEA_SANITIZED)
endif()
if(FOVEA_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# fovea_add_library(<name> [TICK] [COMPONENT <core|host>] [SOURCES <file>...] [HEADERS <file>...]
#                   [API <file>...] [PUBLIC <target>...] [PRIVATE <target>...])
# SOURCES are compiled together (see FoveaUnity).
# HEADERS are beside the sources and are included by their path from the root. API are the headers that an outside project
# includes, relative to the folder's include/ or to firmware/include/. With COMPONENT the library and all its headers are
# installed in that component of the CMake package.
function(fovea_add_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "TICK" "COMPONENT" "SOURCES;HEADERS;API;PUBLIC;PRIVATE")
  add_library(${name} STATIC)
  if(arg_API)
    set(base ${CMAKE_CURRENT_SOURCE_DIR}/include)
    if(NOT EXISTS ${base})
      set(base ${PROJECT_SOURCE_DIR}/firmware/include)
    endif()
    list(TRANSFORM arg_API PREPEND ${base}/)
    target_sources(${name} PUBLIC FILE_SET api TYPE HEADERS BASE_DIRS ${base} FILES ${arg_API})
  endif()
  if(arg_COMPONENT)
    target_sources(${name} PUBLIC FILE_SET internal TYPE HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR})
    fovea_install(${name} ${arg_COMPONENT})
  endif()
  fovea_add_sources(${name} SOURCES ${arg_SOURCES} HEADERS ${arg_HEADERS})
  target_link_libraries(${name} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:fovea_warnings>)
  if(arg_TICK)
    target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:fovea_tick>)
  endif()
endfunction()

# fovea_add_sources(<name> [SOURCES <file>...] [HEADERS <file>...])
# Adds the files of a subfolder to the target <name>.
function(fovea_add_sources name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;HEADERS")
  target_sources(${name} PRIVATE ${arg_SOURCES})
  fovea_compile_together(${name} ${arg_SOURCES})
  if(arg_HEADERS)
    list(TRANSFORM arg_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    target_sources(${name} PUBLIC FILE_SET internal FILES ${arg_HEADERS})
  endif()
endfunction()
