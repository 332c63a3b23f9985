# SPDX-License-Identifier: Apache-2.0
# Everything here is a Debian package; packages.txt lists them for ./run.

find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(nlohmann_json 3.9 REQUIRED)
find_package(tl-expected REQUIRED)
find_package(fmt REQUIRED)
find_package(GTest REQUIRED)
find_package(Boost 1.74 REQUIRED CONFIG) # headers: Asio, Beast
find_package(ZLIB REQUIRED)

# Each target that includes Asio links this one. No definition here changes what Asio's functions are: a program that links
# the installed library may have sources that include Asio without it.
add_library(asip_asio INTERFACE)
target_link_libraries(asip_asio INTERFACE Boost::headers Threads::Threads)
target_compile_options(asip_asio INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fcoroutines>)
# Boost 1.74 looks for what clang offered before C++20 had coroutines.
target_compile_definitions(asip_asio INTERFACE
  $<$<CXX_COMPILER_ID:Clang>:BOOST_ASIO_HAS_CO_AWAIT;BOOST_ASIO_HAS_STD_COROUTINE>)

find_package(CLI11 REQUIRED)
find_package(OpenSSL REQUIRED)
pkg_check_modules(mosquitto REQUIRED IMPORTED_TARGET libmosquitto)
pkg_check_modules(utf8proc REQUIRED IMPORTED_TARGET libutf8proc)
pkg_check_modules(sqlite3 REQUIRED IMPORTED_TARGET sqlite3)

# asip_prefer_static(NAME SHARED LIBRARY...): a target that links the static libraries, where all of them are there, else
# SHARED. A program that somebody types waits for each shared library at its start.
function(asip_prefer_static name shared)
  add_library(${name} INTERFACE)
  set(found "")
  foreach(library IN LISTS ARGN)
    find_library(ASIP_STATIC_${library} lib${library}.a)
    mark_as_advanced(ASIP_STATIC_${library})
    list(APPEND found "${ASIP_STATIC_${library}}")
  endforeach()
  if(NOT ASIP_STATIC OR ASIP_SANITIZE OR found MATCHES "NOTFOUND")
    target_link_libraries(${name} INTERFACE ${shared})
    return()
  endif()
  if(TARGET ${shared})
    target_include_directories(${name} SYSTEM INTERFACE "$<TARGET_PROPERTY:${shared},INTERFACE_INCLUDE_DIRECTORIES>")
  endif()
  target_link_libraries(${name} INTERFACE ${found})
endfunction()

# The same for the compiler's own libraries. A program that slept is faster, too: it has fewer pages to find again.
# Its own addresses, which each start corrects, are then noted in a kilobyte in place of 150.
include(CheckLinkerFlag)
check_linker_flag(CXX "LINKER:--fatal-warnings,-z,pack-relative-relocs" ASIP_PACKS_RELOCATIONS)
function(asip_prefer_static_runtime program)
  if(ASIP_STATIC AND NOT ASIP_SANITIZE)
    target_link_options(${program} PRIVATE -static-libstdc++ -static-libgcc)
    if(ASIP_PACKS_RELOCATIONS)
      target_link_options(${program} PRIVATE "LINKER:-z,pack-relative-relocs")
    endif()
  endif()
endfunction()

asip_prefer_static(asip_utf8proc PkgConfig::utf8proc utf8proc)
asip_prefer_static(asip_resolv resolv resolv)

# simavr's own .pc file adds include paths of its build machine; the library and libelf are all it needs.
find_path(SIMAVR_INCLUDE_DIR simavr/sim_avr.h REQUIRED)
find_library(SIMAVR_LIBRARY NAMES libsimavr.a simavr REQUIRED)
find_library(ELF_LIBRARY elf REQUIRED)
add_library(simavr INTERFACE)
target_include_directories(simavr SYSTEM INTERFACE "${SIMAVR_INCLUDE_DIR}" "${SIMAVR_INCLUDE_DIR}/simavr")
target_link_libraries(simavr INTERFACE "${SIMAVR_LIBRARY}" "${ELF_LIBRARY}")
