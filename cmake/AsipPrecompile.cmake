# SPDX-License-Identifier: Apache-2.0
# Headers that nearly every source includes are parsed once: most of the time of a compiler goes there. A source still names
# what it uses: it must compile with CMAKE_DISABLE_PRECOMPILE_HEADERS, too. Each source is charged with what the inline functions of
# these headers instantiate: no header that few include belongs here. One of CLI11 would cost 2.2 s each, those of Asio 0.5 s.

set(asip_precompiled
  <algorithm> <chrono> <cstdint> <deque> <filesystem> <functional> <map> <memory> <optional> <set> <span> <string> <string_view>
  <unordered_map> <utility> <variant> <vector>
  <nlohmann/json.hpp> <tl/expected.hpp>)

# asip_add_precompiled(NAME LIBS ... HEADERS ... OPTIONS ...): a target whose precompiled headers others use, which are compiled
# with the same options.
function(asip_add_precompiled name)
  cmake_parse_arguments(arg "" "" "LIBS;HEADERS;OPTIONS" ${ARGN})
  file(GENERATE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp" CONTENT "// Nothing but precompiled headers.\n")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
  target_link_libraries(${name} PRIVATE asip_options ${arg_LIBS} nlohmann_json::nlohmann_json tl::expected)
  target_compile_options(${name} PRIVATE ${arg_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${asip_precompiled} ${arg_HEADERS})
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
endfunction()

# Whether a target links another, itself or through libraries of ours.
function(asip_links target wanted result)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  set(seen "")
  while(libraries)
    list(POP_FRONT libraries library)
    if(library STREQUAL "${wanted}")
      set(${result} TRUE PARENT_SCOPE)
      return()
    endif()
    if(TARGET "${library}" AND NOT library IN_LIST seen)
      list(APPEND seen "${library}")
      get_target_property(more ${library} INTERFACE_LINK_LIBRARIES)
      if(more)
        list(APPEND libraries ${more})
      endif()
    endif()
  endwhile()
  set(${result} FALSE PARENT_SCOPE)
endfunction()

# Everything below this folder that links asip_options uses them, except the firmware for the host, which is C++11 at heart
# and gives namespaces other names by macros.
# What fuzz targets explore notes which branches it takes.
function(asip_precompile folder)
  get_property(explored GLOBAL PROPERTY asip_explored)
  get_property(targets DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    if(NOT "${type}" MATCHES "^(STATIC_LIBRARY|EXECUTABLE)$")
      continue()
    endif()
    get_target_property(libraries ${target} LINK_LIBRARIES)
    asip_links(${target} asip_options is_ours)
    if(NOT is_ours OR "asip_firmware_warnings" IN_LIST libraries)
      if(target IN_LIST explored)
        target_compile_options(${target} PRIVATE ${asip_explores})
      endif()
      continue()
    endif()
    if("asip_test_options" IN_LIST libraries)
      target_compile_definitions(${target} PRIVATE GTEST_HAS_PTHREAD=1) # fuzz targets do not link GoogleTest
      target_precompile_headers(${target} REUSE_FROM asip_precompiled_for_tests)
    elseif(target IN_LIST explored)
      target_compile_options(${target} PRIVATE ${asip_explores})
      target_precompile_headers(${target} REUSE_FROM asip_precompiled_to_explore)
    elseif("asip_asio" IN_LIST libraries)
      target_precompile_headers(${target} REUSE_FROM asip_precompiled_with_asio)
    else()
      target_precompile_headers(${target} REUSE_FROM asip_precompiled)
    endif()
  endforeach()
  get_property(folders DIRECTORY "${folder}" PROPERTY SUBDIRECTORIES)
  foreach(below IN LISTS folders)
    asip_precompile("${below}")
  endforeach()
endfunction()

set(asip_explores -fsanitize=fuzzer-no-link)
asip_add_precompiled(asip_precompiled)
asip_add_precompiled(asip_precompiled_with_asio LIBS asip_asio HEADERS
  <boost/asio/io_context.hpp> <boost/asio/ip/tcp.hpp> <boost/asio/local/stream_protocol.hpp> <boost/asio/posix/stream_descriptor.hpp>
  <boost/asio/post.hpp> <boost/asio/signal_set.hpp> <boost/asio/steady_timer.hpp>)
if(ASIP_SANITIZE)
  asip_add_precompiled(asip_precompiled_to_explore OPTIONS ${asip_explores})
endif()
asip_add_precompiled(asip_precompiled_for_tests LIBS asip_test_options GTest::gmock HEADERS <gmock/gmock.h> <gtest/gtest.h>)
