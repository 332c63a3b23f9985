# SPDX-License-Identifier: Apache-2.0
# How everything of ours that runs on the host is compiled.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)

# Where ccache is installed, what was compiled once is not compiled again: not in another clone or branch either.
find_program(ASIP_CCACHE ccache)
mark_as_advanced(ASIP_CCACHE)
if(ASIP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  foreach(language C CXX)
    set(CMAKE_${language}_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${ASIP_CCACHE})
  endforeach()
endif()

# Warnings are kept, so that ./run test can fail over them with the flags of every other build: what ./run demo compiled is not
# compiled again.
if(CMAKE_BUILD_TYPE STREQUAL "Dev" AND CMAKE_GENERATOR STREQUAL "Ninja")
  foreach(language C CXX)
    list(PREPEND CMAKE_${language}_COMPILER_LAUNCHER "${CMAKE_CURRENT_LIST_DIR}/note_warnings")
  endforeach()
endif()

# The flags of a build type of ours, unless somebody set them. FORCE, because project() has put an empty value into the
# cache by now.
function(asip_build_type name flags)
  foreach(language C CXX)
    if(NOT CMAKE_${language}_FLAGS_${name})
      set(CMAKE_${language}_FLAGS_${name} "${flags}" CACHE STRING "Flags of this build type" FORCE)
    endif()
  endforeach()
endfunction()

# What a first try and the tests wait for: -Og without debug information takes the compiler 40 % less time than -O2 with
# lines, and programs that mostly wait notice nothing. Tests themselves are not optimised (AsipTest).
asip_build_type(DEV "-Og")
# Unoptimised: compiling with sanitizers costs more than what runs.
asip_build_type(SANITIZE "-O0 -g1")

# Interface target that each target of ours links: warnings, and sanitizers where asked for.
add_library(asip_options INTERFACE)
target_compile_options(asip_options INTERFACE
  "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wnon-virtual-dtor;-Woverloaded-virtual;-Wcast-align>") # not of those who use the installed library
if(ASIP_WERROR)
  target_compile_options(asip_options INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 15)
  # GCC 12 to 14 see overlapping and overlong copies inside std::string's operator+ when they optimise (GCC bug 105651); which ones
  # depends on the sources that are compiled as one.
  target_compile_options(asip_options INTERFACE
    "$<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-array-bounds>>")
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  if(CMAKE_SIZEOF_VOID_P EQUAL 4)
    # On 32-bit ARM GCC notes at each call what GCC 7 changed. A 32-bit system on a 64-bit kernel calls its processor aarch64.
    target_compile_options(asip_options INTERFACE $<BUILD_INTERFACE:-Wno-psabi>)
  endif()
  # For all, not for those alone that use coroutines: precompiled headers are compiled with the same language.
  target_compile_options(asip_options INTERFACE $<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:-fcoroutines>>)
  # From when on the compiler collects its garbage: that is a tenth of its time otherwise.
  target_compile_options(asip_options INTERFACE
    "$<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:SHELL:--param ggc-min-heapsize=${ASIP_COMPILER_HEAP} --param ggc-min-expand=${ASIP_COMPILER_GROWTH}>>")
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Several sources are compiled as one: what each keeps to itself looks as if it stood in a header.
  target_compile_options(asip_options INTERFACE $<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>>)
endif()
target_include_directories(asip_options INTERFACE
  "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>" "$<INSTALL_INTERFACE:include>")
target_compile_features(asip_options INTERFACE cxx_std_20)
target_compile_definitions(asip_options INTERFACE ASIP_VERSION="${PROJECT_VERSION}")

if(ASIP_SANITIZE)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "ASIP_SANITIZE needs clang (its libFuzzer): use the preset asan")
  endif()
  # One build for programs, unit tests and fuzz targets; the fuzz targets themselves add the driver.
  # At fixed addresses: what the sanitizers note of each line is a million pointers, which each start of a program would
  # have to relocate.
  # Libraries that fuzz targets explore note their branches, too (AsipPrecompile): everywhere that costs a third more.
  # Checks of each pointer cost the compiler a third; AddressSanitizer sees what is worth seeing of null and of objects' sizes,
  # and the one source that takes bytes for an object aligns them.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=null,alignment,object-size,vptr -fno-sanitize-recover=all
    -fno-omit-frame-pointer -fno-pie)
  # The deprecated get_temporary_buffer is used by stable_sort of libstdc++ 12 itself.
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Wno-deprecated-declarations>)
  # lld, of the same version as clang, takes a fifth of the processor time that the default linker takes for programs of this size.
  string(REGEX MATCH "^[0-9]+" lld "${CMAKE_CXX_COMPILER_VERSION}")
  add_link_options(-fsanitize=address,undefined -no-pie -fuse-ld=lld-${lld})
endif()
