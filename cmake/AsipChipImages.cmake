# SPDX-License-Identifier: Apache-2.0
# Images of our library for chips that are not AVR, with the small Arduino cores of tests/chips: for emulators, in tests.
#
#   asip_add_chip_image(NAME CHIP rp2040 SKETCH FILE.ino [DEFINES NAME=VALUE...])
#
# makes ${ASIP_IMAGES}/NAME.elf, target NAME_image. As asip_add_image does for AVR; the library is compiled as the IDE compiles it.

cmake_policy(SET CMP0116 OLD) # as in AsipFirmware
set(ASIP_CHIPS "${CMAKE_CURRENT_LIST_DIR}/../tests/chips" CACHE INTERNAL "Cores and tests of chips that are not AVR")

set(asip_chip_common -g -Os -ffunction-sections -fdata-sections -fno-exceptions -fno-rtti -fno-threadsafe-statics -MMD
  -Wall -Wextra -DARDUINO=10819)
if(ASIP_WERROR)
  list(APPEND asip_chip_common -Werror)
endif()

set(asip_chip_rp2040_tool arm-none-eabi)
set(asip_chip_rp2040_flags -mcpu=cortex-m0plus -mthumb --specs=picolibc.specs)
set(asip_chip_rp2040_defines -DARDUINO_ARCH_RP2040 -DASIP_ANALOG_BITS=12)
set(asip_chip_rp2040_sources core/runtime.cpp rp2040/core.cpp rp2040/flash.cpp rp2040/start.cpp rp2040/uart.cpp rp2040/wire.cpp)

function(asip_add_chip_image name)
  cmake_parse_arguments(arg "" "CHIP;SKETCH" "DEFINES" ${ARGN})
  set(chip ${arg_CHIP})
  set(tool ${asip_chip_${chip}_tool})
  set(folder "${PROJECT_BINARY_DIR}/firmware/${name}")
  file(MAKE_DIRECTORY "${folder}/asip/parts" "${folder}/asip/services" "${folder}/core" "${folder}/${chip}" "${ASIP_IMAGES}")
  list(TRANSFORM arg_DEFINES PREPEND -D)
  set(flags ${asip_chip_${chip}_flags} ${asip_chip_common} ${asip_chip_${chip}_defines} ${arg_DEFINES}
    -I${ASIP_CHIPS} -I${ASIP_CHIPS}/core -I${ASIP_CHIPS}/${chip} -I${ASIP_LIBRARY_DIR})

  set(objects)
  list(TRANSFORM asip_library_sources PREPEND "${ASIP_LIBRARY_DIR}/" OUTPUT_VARIABLE library)
  list(TRANSFORM asip_chip_${chip}_sources PREPEND "${ASIP_CHIPS}/" OUTPUT_VARIABLE core)
  get_filename_component(sketch "${arg_SKETCH}" ABSOLUTE)
  foreach(source ${library} ${core} ${sketch})
    string(REPLACE "${ASIP_LIBRARY_DIR}/" "" object "${source}")
    string(REPLACE "${ASIP_CHIPS}/" "" object "${object}")
    if(source STREQUAL sketch)
      get_filename_component(object "${source}" NAME)
    endif()
    set(object "${folder}/${object}.o")
    set(language -std=gnu++17)
    if(source IN_LIST library OR source STREQUAL sketch)
      set(language -std=gnu++11)
    endif()
    if(source STREQUAL sketch)
      list(APPEND language -x c++ -include Arduino.h)
    endif()
    file(RELATIVE_PATH shown "${PROJECT_BINARY_DIR}" "${object}")
    add_custom_command(OUTPUT "${object}"
      COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} ${tool}-g++ ${language} ${flags} -MF "${object}.d" -MT "${shown}" -c "${source}" -o "${object}"
      WORKING_DIRECTORY "${PROJECT_BINARY_DIR}" DEPENDS "${source}" DEPFILE "${object}.d" COMMENT "${chip} ${shown}" VERBATIM)
    list(APPEND objects "${object}")
  endforeach()

  set(elf "${ASIP_IMAGES}/${name}.elf")
  set(script "${ASIP_CHIPS}/${chip}/${chip}.ld")
  add_custom_command(OUTPUT "${elf}"
    COMMAND ${tool}-gcc ${asip_chip_${chip}_flags} -nostartfiles -Wl,--gc-sections -Wl,--nmagic -T "${script}" -o "${elf}" ${objects} -lm
    DEPENDS ${objects} "${script}" COMMENT "image ${name}.elf" VERBATIM)
  add_custom_target(${name}_image DEPENDS "${elf}")
endfunction()
