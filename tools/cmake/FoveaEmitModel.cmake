# SPDX-License-Identifier: Apache-2.0
# fovea_emit_model(<target> <arm>...): writes the models of shipped arms as `fovea model ARM --emit-cpp` does. <target> includes
# them as "emitted/<arm>.hpp".
function(fovea_emit_model target)
  set(robots ${PROJECT_SOURCE_DIR}/firmware/host/robots/share)
  file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/emitted)
  foreach(arm IN LISTS ARGN)
    add_custom_command(OUTPUT emitted/${arm}.hpp
      COMMAND fovea-emit-model ${arm} > emitted/${arm}.hpp
      DEPENDS fovea-emit-model fovea_firmware_share ${robots}/${arm}.urdf ${robots}/${arm}.toml VERBATIM)
    target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/emitted/${arm}.hpp)
  endforeach()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
endfunction()
