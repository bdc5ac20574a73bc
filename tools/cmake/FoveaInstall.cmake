# SPDX-License-Identifier: Apache-2.0
# Installation folders, the CMake package `fovea`, and the Debian packages.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(FOVEA_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/fovea)

# Installs a library with its headers, as fovea::<name without fovea_> in <component> of the package.
function(fovea_install target component)
  string(REPLACE "fovea_" "" export_name ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${export_name})
  get_target_property(sets ${target} INTERFACE_HEADER_SETS)
  set(header_sets)
  if("api" IN_LIST sets)
    list(APPEND header_sets FILE_SET api DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
  endif()
  if("internal" IN_LIST sets)
    list(APPEND header_sets FILE_SET internal DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fovea/internal COMPONENT dev)
  endif()
  install(TARGETS ${target} EXPORT fovea-${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
    OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/fovea COMPONENT dev
    ${header_sets})
endfunction()

# Call it once, after all targets are defined.
function(fovea_install_package)
  foreach(component core host)
    install(EXPORT fovea-${component} NAMESPACE fovea:: FILE fovea-${component}.cmake
      DESTINATION ${FOVEA_PACKAGE_FOLDER} COMPONENT dev)
  endforeach()
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/fovea-config-version.cmake
    VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fovea-config-version.cmake
    ${PROJECT_SOURCE_DIR}/tools/cmake/fovea-config.cmake
    DESTINATION ${FOVEA_PACKAGE_FOLDER} COMPONENT dev)
  # The prefix is relative to the .pc file, so an installation can be moved.
  file(RELATIVE_PATH FOVEA_PREFIX_OF_PC /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  configure_file(${PROJECT_SOURCE_DIR}/tools/cmake/fovea.pc.in ${CMAKE_CURRENT_BINARY_DIR}/fovea.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fovea.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/firmware/host/recording/log/proto/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fovea/proto
    COMPONENT data FILES_MATCHING PATTERN "*.proto")
  foreach(program fovea fovea-sim fovea-hw fovea-bench)
    install(FILES ${PROJECT_SOURCE_DIR}/tools/completion/fovea.bash RENAME ${program}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime)
  endforeach()
  # Below /usr, Debian's zsh reads vendor-completions. Below /usr/local and on other systems, zsh reads site-functions.
  foreach(folder site-functions vendor-completions)
    install(FILES ${PROJECT_SOURCE_DIR}/tools/completion/_fovea DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${folder}
      COMPONENT runtime)
  endforeach()
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/firmware/host/robots/share/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fovea/robots
    COMPONENT data)
  set(packages dev libfovea-dev data fovea-data runtime fovea)
  while(packages)
    list(POP_FRONT packages component package)
    install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  endwhile()
  fovea_debian_packages()
endfunction()

# `cpack --config build/<preset>/CPackConfig.cmake` builds the packages fovea (programs), libfovea-dev and fovea-data.
macro(fovea_debian_packages)
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_CONTACT "The Fovea authors <fovea@localhost>")
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_STRIP_FILES ON)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_COMPONENTS_ALL dev data runtime)
  set(CPACK_DEBIAN_PACKAGE_SECTION science)

  set(CPACK_DEBIAN_DEV_PACKAGE_NAME libfovea-dev)
  set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
  set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "fovea-data, libeigen3-dev, libfmt-dev, libtomlplusplus-dev, liburdfdom-dev, libopencv-dev")
  set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers, libraries and CMake package")

  set(CPACK_DEBIAN_DATA_PACKAGE_NAME fovea-data)
  set(CPACK_DEBIAN_DATA_PACKAGE_ARCHITECTURE all)
  set(CPACK_COMPONENT_DATA_DESCRIPTION "Robots, scenarios, the report's page, layouts")

  set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME fovea)
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "fovea-data, libjs-dygraphs, libjs-three")
  if(FOVEA_SIM)
    string(APPEND CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS ", libegl1, libgl1-mesa-dri")
  endif()
  set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "The programs")
  include(CPack)
endmacro()
