# SPDX-License-Identifier: Apache-2.0
# fovea_add_test(<name> SOURCES <file>... LIBS <target>... [LABELS <label>...] [TIMEOUT <s>] [LOCK <name>])
# Adds one executable. Each of its tests is one ctest test, labelled LABELS/name: `ctest -L '^log_test$'` runs one
# program, `ctest -LE slow` leaves out "slow/closed_loop_test". (One label, because gtest_discover_tests keeps only the
# first of a list.) Tests with the same LOCK never run at the same time.
function(fovea_add_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TIMEOUT;LOCK" "SOURCES;LIBS;LABELS")
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  if(FOVEA_SANITIZE)
    math(EXPR arg_TIMEOUT "4 * ${arg_TIMEOUT}")
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBS} fovea_test_places GTest::gmock GTest::gtest_main fovea_warnings)
  list(APPEND arg_LABELS ${name})
  list(JOIN arg_LABELS / label)
  set(properties TIMEOUT ${arg_TIMEOUT} LABELS ${label})
  if(arg_LOCK)
    list(APPEND properties RESOURCE_LOCK ${arg_LOCK})
  endif()
  # On a busy machine a sanitized program needs more than the default five seconds to list its tests.
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120 NO_PRETTY_VALUES PROPERTIES ${properties})
endfunction()
