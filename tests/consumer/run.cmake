# Installs BUILD_DIR into a folder of its own, builds the project beside this file against that, and runs what it makes.
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
# What is installed must not know where it was built.
file(GLOB_RECURSE package ${WORK_DIR}/prefix/*.cmake)
foreach(file IN LISTS package)
  file(READ ${file} text)
  if(text MATCHES "${BUILD_DIR}" OR text MATCHES "${SOURCE_DIR}")
    message(FATAL_ERROR "${file} names the folder that it was built in")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK_DIR})
