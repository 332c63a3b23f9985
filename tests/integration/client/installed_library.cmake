# SPDX-License-Identifier: Apache-2.0
# Installs the library into a folder of its own and builds a project against nothing but that. Run as
#   cmake -DBUILD=... -DSOURCE=... -DCOMPILER=... -P installed_library.cmake
set(place "${BUILD}/installed_library")
file(REMOVE_RECURSE "${place}")

function(must)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
endfunction()

must(${CMAKE_COMMAND} --install "${BUILD}" --component library --prefix "${place}/prefix")
must(${CMAKE_COMMAND} -S "${SOURCE}/tests/integration/client/installed" -B "${place}/build" -G Ninja
     "-DCMAKE_PREFIX_PATH=${place}/prefix" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DASIP_EXAMPLES=${SOURCE}/examples" "-DASIP_INCLUDE=${place}/prefix/include")
must(${CMAKE_COMMAND} --build "${place}/build")

execute_process(COMMAND "${place}/build/blink" /dev/asip-no-such-port RESULT_VARIABLE status ERROR_VARIABLE errors)
if(NOT status EQUAL 1 OR NOT errors MATCHES "asip-no-such-port is not there")
  message(FATAL_ERROR "the installed blink ended with ${status}: ${errors}")
endif()

# Two definitions of a function of Asio in one program would end it by a signal.
execute_process(COMMAND "${place}/build/beside" RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "a program that has Asio of its own beside the library ended with ${status}: ${output}")
endif()
file(REMOVE_RECURSE "${place}")
