# SPDX-License-Identifier: Apache-2.0
# Ways to declare tests. Each source list is written out; nothing is globbed.

add_custom_target(unit-tests)
add_custom_target(integration-tests)
add_custom_target(fuzz-targets)

# Code of tests: compiled quickly, whatever the code under test is compiled with. Without the checks of each pointer the
# sanitized tests take the compiler a quarter less, and AddressSanitizer still sees what is worth seeing there.
add_library(asip_test_options INTERFACE)
target_compile_options(asip_test_options INTERFACE $<$<CONFIG:Dev>:-O0>
  $<$<CONFIG:Sanitize>:-fno-sanitize=null,alignment,object-size,vptr>)

# One executable of unit tests, one CTest entry: starting it costs more than most tests in it.
function(asip_add_unit_test name)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE asip_options asip_test_options ${arg_LIBS} GTest::gmock GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
  # For the sanitizers; other builds do not look at it.
  set_tests_properties(${name} PROPERTIES LABELS unit TIMEOUT 1800
    ENVIRONMENT ASAN_OPTIONS=detect_stack_use_after_return=1)
  add_dependencies(unit-tests ${name})
endfunction()

# Integration tests: each test case is a CTest entry, so that they run side by side. ALONE is a filter of GoogleTest: floods
# that leave a simulated board of another test no time to be one.
function(asip_add_integration_test name)
  cmake_parse_arguments(arg "" "TIMEOUT;ALONE" "SOURCES;LIBS;DEPENDS" ${ARGN})
  if(NOT ASIP_INTEGRATION)
    return()
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE asip_options asip_test_options ${arg_LIBS} GTest::gmock GTest::gtest_main)
  add_dependencies(integration-tests ${name})
  if(arg_DEPENDS)
    add_dependencies(${name} ${arg_DEPENDS})
  endif()
  include(GoogleTest)
  set(common DISCOVERY_MODE PRE_TEST TEST_PREFIX "${name}." EXTRA_ARGS --gtest_brief=1)
  set(properties LABELS integration TIMEOUT ${arg_TIMEOUT})
  if(arg_ALONE)
    gtest_discover_tests(${name} ${common} TEST_FILTER "-${arg_ALONE}" PROPERTIES ${properties})
    gtest_discover_tests(${name} ${common} TEST_FILTER "${arg_ALONE}" PROPERTIES ${properties} RUN_SERIAL TRUE)
  else()
    gtest_discover_tests(${name} ${common} PROPERTIES ${properties})
  endif()
endfunction()

# A fuzz target: LLVMFuzzerTestOneInput in SOURCES, its committed corpus in CORPUS (a folder).
# With ASIP_SANITIZE it is a libFuzzer program; without, a plain one. A unit test replays the corpus with either.
function(asip_add_fuzz_target name)
  cmake_parse_arguments(arg "" "CORPUS" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE asip_options asip_test_options ${arg_LIBS})
  if(ASIP_SANITIZE)
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/fuzzers")
    file(GENERATE OUTPUT "${PROJECT_BINARY_DIR}/fuzzers/${name}.corpus" CONTENT "${arg_CORPUS}\n")
    set(replay -runs=0)
    add_dependencies(fuzz-targets ${name})
  else()
    target_sources(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests/fuzz/replay_main.cpp")
  endif()
  add_test(NAME ${name}_corpus COMMAND ${name} ${replay} "${arg_CORPUS}")
  set_tests_properties(${name}_corpus PROPERTIES LABELS unit TIMEOUT 60)
  add_dependencies(unit-tests ${name})
endfunction()
