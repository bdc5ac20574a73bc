# SPDX-License-Identifier: Apache-2.0
# Installs BUILD_DIR into its own folder, builds the project SOURCE_DIR against it, and runs the programs built.
foreach(name BUILD_DIR WORK_DIR SOURCE_DIR GENERATOR CXX)
  if(NOT ${name})
    message(FATAL_ERROR "${name} is not set")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK_DIR})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIR} -B ${WORK_DIR}/build
  -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_PREFIX_PATH=${WORK_DIR}/prefix -D CMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK_DIR}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK_DIR}/build/consumer ${WORK_DIR}/prefix/share/fovea/robots/panda.toml
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${WORK_DIR}/build/driver/cart_arm_test COMMAND_ERROR_IS_FATAL ANY)
# Builds and runs pkg_config.cpp with the flags from pkg-config.
file(GLOB_RECURSE pc ${WORK_DIR}/prefix/*/fovea.pc)
get_filename_component(pc_folder ${pc} DIRECTORY)
set(ENV{PKG_CONFIG_PATH} ${pc_folder})
execute_process(COMMAND sh -c "${CXX} -std=c++20 -O1 $0 $(pkg-config --cflags --libs fovea) -o $1 && $1"
  ${SOURCE_DIR}/../pkg_config.cpp ${WORK_DIR}/pkg_config COMMAND_ERROR_IS_FATAL ANY)
# Other installed files: the log's messages, shell completion.
foreach(file share/fovea/proto/fovea/tick.proto share/fovea/proto/foxglove/image.proto
        share/bash-completion/completions/fovea-sim share/zsh/site-functions/_fovea
        share/zsh/vendor-completions/_fovea)
  if(NOT EXISTS ${WORK_DIR}/prefix/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
# No installed package file may contain the path of the build or of the source.
file(GLOB_RECURSE package ${WORK_DIR}/prefix/*.cmake ${WORK_DIR}/prefix/*.pc)
foreach(file IN LISTS package)
  file(READ ${file} text)
  if(text MATCHES "${BUILD_DIR}" OR text MATCHES "${SOURCE_DIR}")
    message(FATAL_ERROR "${file} contains the path of the build or of the source")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK_DIR})
