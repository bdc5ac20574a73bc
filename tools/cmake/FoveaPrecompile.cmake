# SPDX-License-Identifier: Apache-2.0
# Headers that most sources of a library include, compiled once for all of them. GCC alone, and not under the address
# sanitizer: that build compiles each source by itself, so that a source still has to include what it uses.
option(FOVEA_PRECOMPILE "Precompile the headers of Eigen, fmt, JSON, OpenCV and protobuf" ON)
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR CMAKE_SYSTEM_NAME STREQUAL Generic
   OR FOVEA_SANITIZE MATCHES "address")
  set(FOVEA_PRECOMPILE OFF)
endif()

set(fovea_tick_headers
  <Eigen/Core> <Eigen/Geometry> <Eigen/SVD> <algorithm> <array> <cmath> <cstdint> <limits> <optional> <span>)
set(fovea_host_headers ${fovea_tick_headers}
  <atomic> <chrono> <condition_variable> <deque> <filesystem> <fmt/format.h> <fstream> <functional> <iostream> <map>
  <memory> <mutex> <nlohmann/json.hpp> <set> <sstream> <string> <thread> <variant> <vector>)
set(fovea_picture_headers ${fovea_host_headers}
  <google/protobuf/generated_message_util.h> <google/protobuf/message.h> <google/protobuf/repeated_field.h>
  <opencv2/core.hpp> <opencv2/imgproc.hpp>)

# fovea_precompile(<target> <header>...): `target` compiles these once for its sources.
function(fovea_precompile target)
  if(FOVEA_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# fovea_precompile_as(<owner> <target>...): each `target`, whose flags are those of `owner`, uses what it compiled.
function(fovea_precompile_as owner)
  if(FOVEA_PRECOMPILE)
    foreach(target IN LISTS ARGN)
      target_precompile_headers(${target} REUSE_FROM ${owner})
    endforeach()
  endif()
endfunction()
