# SPDX-License-Identifier: Apache-2.0
# Ways to declare tests. Each source list is written out; nothing is globbed.
#
# The label of a test says its tier; `./run` chooses by labels alone.
#   quick       ./run test: a newcomer and each commit need it
#   more        ./run test more: the rest of continuous integration
#   sanitized   ./run test more, with programs built with sanitizers
#   long        ./run test long: minutes for each test
# Tests that start nothing have the label `unit` beside `quick`. Compiled with sanitizers, ./run test more runs those of rooms that take bytes
# apart or keep buffers (SANITIZED), and ./run test long all (label `units`).

add_custom_target(unit-tests)
add_custom_target(all-unit-tests DEPENDS unit-tests)
add_custom_target(quick-tests) # what tests of tier quick run
add_custom_target(more-tests)  # what tests of tier more run, without what has sanitizers
add_custom_target(long-tests)
add_custom_target(integration-tests DEPENDS quick-tests more-tests long-tests)
add_custom_target(fuzz-targets)
add_dependencies(quick-tests unit-tests)

# Code of tests: compiled quickly, whatever the code under test is compiled with.
add_library(asip_test_options INTERFACE)
target_compile_options(asip_test_options INTERFACE $<$<CONFIG:Dev>:-O0>)

# One executable of unit tests, one CTest entry: starting it costs more than most tests in it. TIER more: ./run test leaves it
# out. SANITIZED: ./run test more has it with sanitizers, too.
function(asip_add_unit_test name)
  cmake_parse_arguments(arg "SANITIZED" "TIER" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE asip_options asip_test_options ${arg_LIBS} GTest::gmock GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
  set(labels quick unit)
  if(ASIP_SANITIZE AND NOT arg_SANITIZED)
    set(labels units)
    add_dependencies(all-unit-tests ${name})
  elseif(arg_TIER AND NOT ASIP_SANITIZE)
    set(labels ${arg_TIER})
    add_dependencies(${arg_TIER}-tests ${name})
  else()
    add_dependencies(unit-tests ${name})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT 1800
    ENVIRONMENT ASAN_OPTIONS=detect_stack_use_after_return=1)
endfunction()

# asip_test(NAME TIER [PROPERTY VALUE...]): the tier and other properties of a test that add_test() declared. No value may be
# a list.
function(asip_test name tier)
  set_tests_properties(${name} PROPERTIES LABELS ${tier} ${ARGN})
endfunction()

# asip_add_integration_test(NAME SOURCES... [LIBS...] [DEPENDS...] [TIMEOUT SECONDS] [TIER TIER]
#                           [MORE FILTER] [PLAIN FILTER] [HEAVY FILTER] [LONG FILTER])
# Each test case is a CTest entry, so that tests run side by side. TIER (quick) is the tier of all cases that no filter
# names. Filters are those of GoogleTest, without negative patterns; a case that several name belongs to the first of them.
#   MORE    tier more, with programs built with sanitizers
#   PLAIN   tier more, with programs without sanitizers: the test starts none of ours, or counts on their speed
#   HEAVY   as PLAIN, and takes half of the places in which tests run: its floods leave other tests too little time
#   LONG    tier long
# TIER more means MORE for the cases that no filter names, TIER plain means PLAIN.
function(asip_add_integration_test name)
  cmake_parse_arguments(arg "" "TIMEOUT;TIER;MORE;PLAIN;HEAVY;LONG" "SOURCES;LIBS;DEPENDS" ${ARGN})
  if(NOT ASIP_INTEGRATION)
    return()
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  if(NOT arg_TIER)
    set(arg_TIER quick)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE asip_options asip_test_options ${arg_LIBS} GTest::gmock GTest::gtest_main)
  if(arg_DEPENDS)
    add_dependencies(${name} ${arg_DEPENDS})
  endif()
  string(REPLACE "plain" "more" first "${arg_TIER}")
  add_dependencies(${first}-tests ${name})
  if(arg_MORE OR arg_PLAIN OR arg_HEAVY)
    add_dependencies(more-tests ${name})
  endif()
  if(arg_LONG)
    add_dependencies(long-tests ${name})
  endif()

  include(GoogleTest)
  set(common DISCOVERY_MODE PRE_TEST TEST_PREFIX "${name}." EXTRA_ARGS --gtest_brief=1)
  set(rest ${arg_MORE} ${arg_PLAIN} ${arg_HEAVY} ${arg_LONG})
  list(JOIN rest ":" rest)
  set(filter_quick "-${rest}")
  set(before "")
  foreach(group MORE PLAIN HEAVY LONG)
    string(TOLOWER ${group} lower)
    set(filter_${lower} "")
    if(arg_${group})
      list(JOIN before ":" others)
      set(filter_${lower} "${arg_${group}}-${others}")
      list(APPEND before "${arg_${group}}")
    endif()
  endforeach()
  if(NOT arg_TIER STREQUAL "quick")
    set(filter_quick "")
    if(filter_${arg_TIER})
      message(FATAL_ERROR "${name}: TIER ${arg_TIER} and a filter of the same tier")
    endif()
    set(filter_${arg_TIER} "-${rest}")
  endif()
  set(properties_quick LABELS quick)
  set(properties_more LABELS sanitized)
  math(EXPR sanitized_timeout "2 * ${arg_TIMEOUT}") # a program with sanitizers takes twice the processor
  list(APPEND properties_more TIMEOUT ${sanitized_timeout})
  set(properties_plain LABELS more)
  set(properties_heavy LABELS more PROCESSORS 4)
  set(properties_long LABELS long)
  foreach(group quick more plain heavy long)
    if(filter_${group})
      gtest_discover_tests(${name} ${common} TEST_FILTER "${filter_${group}}"
        PROPERTIES TIMEOUT ${arg_TIMEOUT} ${properties_${group}})
    endif()
  endforeach()
endfunction()

# asip_install_peer(NAME FIXTURE FOLDER COMMAND...): programs of others, which COMMAND installs into FOLDER of the build folder: once, for
# all tests that need FIXTURE. What is wrong with them fails here, not in a test that uses them.
function(asip_install_peer name fixture folder)
  add_test(NAME ${name}_installed COMMAND ${ARGN} "${PROJECT_BINARY_DIR}/${folder}")
  asip_test(${name}_installed long TIMEOUT 600 FIXTURES_SETUP ${fixture} COST 100)
endfunction()

# asip_install_npm_peer(NAME FIXTURE FOLDER): those that package.json beside the CMakeLists.txt names.
function(asip_install_npm_peer name fixture folder)
  asip_install_peer(${name} ${fixture} ${folder} ${PROJECT_SOURCE_DIR}/tests/support/install_from_npm ${CMAKE_CURRENT_SOURCE_DIR})
endfunction()

# asip_add_peer_test(NAME MODULE FIXTURE TIMEOUT [VARIABLE FOLDER]): unit tests in Python with such programs, which find them in VARIABLE.
function(asip_add_peer_test name module fixture timeout)
  set(environment "ASIP_BUILD=${PROJECT_BINARY_DIR}" "PYTHONPATH=${PROJECT_SOURCE_DIR}/tests/support")
  if(ARGC EQUAL 6)
    list(APPEND environment "${ARGV4}=${PROJECT_BINARY_DIR}/${ARGV5}")
  endif()
  add_test(NAME ${name} COMMAND ${ASIP_PYTHON} -B -m unittest -v ${module} WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
  asip_test(${name} long TIMEOUT ${timeout} PROCESSORS 2 FIXTURES_REQUIRED ${fixture})
  set_tests_properties(${name} PROPERTIES ENVIRONMENT "${environment}")
endfunction()

# A fuzz target: LLVMFuzzerTestOneInput in SOURCES, its committed corpus in CORPUS (a folder). A unit test replays the corpus.
# Only with ASIP_SANITIZE: it is a libFuzzer program.
function(asip_add_fuzz_target name)
  cmake_parse_arguments(arg "" "CORPUS" "SOURCES;LIBS" ${ARGN})
  if(NOT ASIP_SANITIZE)
    return()
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE asip_options asip_test_options ${arg_LIBS})
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  set_property(GLOBAL APPEND PROPERTY asip_explored ${arg_LIBS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/fuzzers")
  file(GENERATE OUTPUT "${PROJECT_BINARY_DIR}/fuzzers/${name}.corpus" CONTENT "${arg_CORPUS}\n")
  add_dependencies(fuzz-targets ${name})
  add_test(NAME ${name}_corpus COMMAND ${name} -runs=0 "${arg_CORPUS}")
  set_tests_properties(${name}_corpus PROPERTIES LABELS unit TIMEOUT 60)
  add_dependencies(unit-tests ${name})
endfunction()
