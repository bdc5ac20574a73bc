# SPDX-License-Identifier: Apache-2.0
# find_package(fovea [COMPONENTS core|host]...)
#   core  hal, model, features, servo, linux_rt, heap_interposer: the code that runs in and around the tick
#   host  vision, calibration, config, robots, servo_keys: the code that needs OpenCV, TOML and URDF; includes core
# Targets are fovea::hal, fovea::servo, ... fovea_SHARE_DIR is where robots and scenarios are.
include(CMakeFindDependencyMacro)

if(NOT fovea_FIND_COMPONENTS)
  set(fovea_FIND_COMPONENTS core)
endif()
foreach(component IN LISTS fovea_FIND_COMPONENTS)
  if(NOT component MATCHES "^(core|host)$")
    set(fovea_FOUND FALSE)
    set(fovea_NOT_FOUND_MESSAGE "fovea has no component \"${component}\"; its components are core and host")
    return()
  endif()
endforeach()

find_dependency(Eigen3 3.4 NO_MODULE)
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/fovea-core.cmake)
set(fovea_core_FOUND TRUE)

if("host" IN_LIST fovea_FIND_COMPONENTS)
  find_dependency(fmt)
  find_dependency(tomlplusplus)
  find_dependency(PkgConfig)
  pkg_check_modules(urdfdom QUIET IMPORTED_TARGET urdfdom)
  if(NOT urdfdom_FOUND)
    set(fovea_FOUND FALSE)
    set(fovea_NOT_FOUND_MESSAGE "fovea's component host needs urdfdom")
    return()
  endif()
  find_dependency(OpenCV 4.6 COMPONENTS core imgproc)
  include(${CMAKE_CURRENT_LIST_DIR}/fovea-host.cmake)
  target_include_directories(fovea::vision SYSTEM INTERFACE ${OpenCV_INCLUDE_DIRS})
  set(fovea_host_FOUND TRUE)
endif()

get_filename_component(fovea_SHARE_DIR ${CMAKE_CURRENT_LIST_DIR}/../../../share/fovea ABSOLUTE)
if(NOT EXISTS ${fovea_SHARE_DIR})  # one level deeper: lib/<architecture>/cmake/fovea
  get_filename_component(fovea_SHARE_DIR ${CMAKE_CURRENT_LIST_DIR}/../../../../share/fovea ABSOLUTE)
endif()
