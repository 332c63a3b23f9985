# SPDX-License-Identifier: Apache-2.0
# Builds Arduino sketches as the Arduino IDE would: same compiler flags (platform.txt of arduino-core-avr), the
# core as one archive per board, our library as another. Host code is not touched: these are custom commands.
#
#   asip_add_image(NAME BOARD uno|nano|mini8|nano168|mega|mega1280|leonardo|644p|1284p
#     SKETCH FILE.ino [SOURCES FILE.cpp...] [DEFINES NAME=VALUE...])
#
# makes ${ASIP_IMAGES}/NAME.elf, target NAME_image, all of them by target firmware-images.

cmake_policy(SET CMP0116 OLD)
set(ASIP_IMAGES "${PROJECT_BINARY_DIR}/firmware/images" CACHE INTERNAL "Folder of the built board images")
set(ASIP_LIBRARY_DIR "${CMAKE_CURRENT_LIST_DIR}/../firmware/src" CACHE INTERNAL "Sources of the Arduino library")
set(ASIP_ARDUINO "/usr/share/arduino/hardware/arduino/avr" CACHE PATH "Arduino AVR core")

set(asip_avr_common -g -Os -ffunction-sections -fdata-sections -MMD -flto -DARDUINO=10819 -DARDUINO_ARCH_AVR)
set(asip_avr_c -std=gnu11 -fno-fat-lto-objects ${asip_avr_common})
set(asip_avr_cxx -std=gnu++11 -fpermissive -fno-exceptions -fno-threadsafe-statics -Wno-error=narrowing
  ${asip_avr_common})
# The pin macros of the core compare an unsigned pin with 0.
set(asip_avr_warnings -Wall -Wextra -Wno-type-limits)
if(ASIP_WERROR)
  list(APPEND asip_avr_warnings -Werror)
endif()

set(asip_library_sources
  asip/Board.cpp
  asip/Error.cpp
  asip/Extensions.cpp
  asip/Hex.cpp
  asip/I2c.cpp
  asip/I2cSensor.cpp
  asip/IoService.cpp
  asip/OneWireBus.cpp
  asip/Out.cpp
  asip/PinInterrupts.cpp
  asip/Request.cpp
  asip/Service.cpp
  asip/Sizes.cpp
  asip/System.cpp
  asip/Timers.cpp
  asip/parts/DhtPulses.cpp
  asip/parts/EchoTimer.cpp
  asip/parts/PixelStrip.cpp
  asip/parts/ServoPulses.cpp
  asip/parts/Stepper.cpp
  asip/parts/ToneTimer.cpp
  asip/services/AsipBump.cpp
  asip/services/AsipDht.cpp
  asip/services/AsipDistance.cpp
  asip/services/AsipEncoders.cpp
  asip/services/AsipHygrometer.cpp
  asip/services/AsipI2cChips.cpp
  asip/services/AsipIlluminance.cpp
  asip/services/AsipLcd.cpp
  asip/services/AsipMotion.cpp
  asip/services/AsipMotors.cpp
  asip/services/AsipNeoPixels.cpp
  asip/services/AsipOneWire.cpp
  asip/services/AsipPixels.cpp
  asip/services/AsipPressure.cpp
  asip/services/AsipReflectance.cpp
  asip/services/AsipServos.cpp
  asip/services/AsipSpi.cpp
  asip/services/AsipSteppers.cpp
  asip/services/AsipThermometers.cpp
  asip/services/AsipTone.cpp
  asip/services/AsipWeather.cpp)

# A Pro Mini at 16 MHz is a nano. Chip, clock, folder of pins_arduino.h and name of each board, as in the boards.txt of its core. The two at the end
# belong to cores that Debian has not: their pins are ours (tests/integration/firmware/variants).
set(asip_board_uno atmega328p 16000000L standard UNO)
set(asip_board_nano atmega328p 16000000L eightanaloginputs NANO)
set(asip_board_mini8 atmega328p 8000000L eightanaloginputs PRO)
set(asip_board_nano168 atmega168 16000000L eightanaloginputs NANO)
set(asip_board_mega atmega2560 16000000L mega MEGA2560)
set(asip_board_mega1280 atmega1280 16000000L mega MEGA)
set(asip_board_leonardo atmega32u4 16000000L leonardo LEONARDO)
set(asip_board_644p atmega644p 16000000L mighty MIGHTY)
set(asip_board_1284p atmega1284p 16000000L mighty MIGHTY)

function(asip_board_flags board out)
  if(NOT DEFINED asip_board_${board})
    message(FATAL_ERROR "asip_add_image: unknown board ${board}")
  endif()
  list(GET asip_board_${board} 0 chip)
  list(GET asip_board_${board} 1 clock)
  list(GET asip_board_${board} 2 variant)
  list(GET asip_board_${board} 3 name)
  set(flags -mmcu=${chip} -DF_CPU=${clock} -DARDUINO_AVR_${name})
  if(board STREQUAL "leonardo")
    list(APPEND flags -DUSB_VID=0x2341 -DUSB_PID=0x8036
      "-DUSB_MANUFACTURER=\"Unknown\"" "-DUSB_PRODUCT=\"Arduino Leonardo\"")
  endif()
  set(folder "${ASIP_ARDUINO}/variants/${variant}")
  if(variant STREQUAL "mighty")
    set(folder "${ASIP_LIBRARY_DIR}/../../tests/integration/firmware/variants/mighty")
  endif()
  set(${out} ${flags} -I${ASIP_ARDUINO}/cores/arduino -I${folder} PARENT_SCOPE)
endfunction()

# One object per source; DEPFILE keeps the headers in sight. Its paths are those of Ninja: hundreds of times CMake would
# be started to make them so.
function(asip_avr_object source object)
  get_filename_component(extension "${source}" LAST_EXT)
  if(extension STREQUAL ".c")
    set(compiler avr-gcc ${asip_avr_c})
  elseif(extension STREQUAL ".S")
    set(compiler avr-gcc -g -x assembler-with-cpp -flto -MMD -DARDUINO=10819)
  else()
    set(compiler avr-g++ ${asip_avr_cxx})
  endif()
  if(extension STREQUAL ".ino")
    list(APPEND compiler -x c++ -include Arduino.h)
  endif()
  file(RELATIVE_PATH shown "${PROJECT_BINARY_DIR}" "${object}")
  add_custom_command(OUTPUT "${object}"
    COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} ${compiler} ${ARGN} -MF "${object}.d" -MT "${shown}" -c "${source}" -o "${object}"
    WORKING_DIRECTORY "${PROJECT_BINARY_DIR}" DEPENDS "${source}" DEPFILE "${object}.d" COMMENT "avr ${shown}" VERBATIM)
endfunction()

function(asip_avr_archive archive)
  add_custom_command(OUTPUT "${archive}"
    COMMAND ${CMAKE_COMMAND} -E rm -f "${archive}"
    COMMAND avr-gcc-ar rcs "${archive}" ${ARGN}
    DEPENDS ${ARGN} VERBATIM)
endfunction()

# The Arduino core of a board, built once. Its WString.cpp needs DECIMAL_DIG, which avr-gcc 5 keeps from C++.
function(asip_add_core board)
  if(TARGET avr_core_${board})
    return()
  endif()
  asip_board_flags(${board} flags)
  set(folder "${PROJECT_BINARY_DIR}/firmware/core_${board}")
  file(MAKE_DIRECTORY "${folder}")
  set(objects)
  foreach(name
      abi.cpp CDC.cpp HardwareSerial.cpp HardwareSerial0.cpp HardwareSerial1.cpp HardwareSerial2.cpp
      HardwareSerial3.cpp hooks.c IPAddress.cpp main.cpp new.cpp PluggableUSB.cpp Print.cpp Stream.cpp Tone.cpp
      USBCore.cpp WInterrupts.c wiring.c wiring_analog.c wiring_digital.c wiring_pulse.c wiring_pulse.S
      wiring_shift.c WMath.cpp WString.cpp)
    asip_avr_object("${ASIP_ARDUINO}/cores/arduino/${name}" "${folder}/${name}.o" -w -DDECIMAL_DIG=17 ${flags})
    list(APPEND objects "${folder}/${name}.o")
  endforeach()
  asip_avr_archive("${folder}/core.a" ${objects})
  add_custom_target(avr_core_${board} DEPENDS "${folder}/core.a")
endfunction()

# Our library for a board and a set of defines, built once; its archive in ${out}, its target in ${out}_target.
function(asip_add_library board defines flags out)
  string(REPLACE "-D" "_" suffix "${defines}")
  string(MAKE_C_IDENTIFIER "${board}${suffix}" key)
  set(folder "${PROJECT_BINARY_DIR}/firmware/library_${key}")
  set(${out} "${folder}/asip.a" PARENT_SCOPE)
  set(${out}_target avr_library_${key} PARENT_SCOPE)
  if(TARGET avr_library_${key})
    return()
  endif()
  file(MAKE_DIRECTORY "${folder}/asip/parts" "${folder}/asip/services")
  set(objects)
  foreach(source ${asip_library_sources})
    asip_avr_object("${ASIP_LIBRARY_DIR}/${source}" "${folder}/${source}.o" ${flags})
    list(APPEND objects "${folder}/${source}.o")
  endforeach()
  asip_avr_archive("${folder}/asip.a" ${objects})
  add_custom_target(avr_library_${key} DEPENDS "${folder}/asip.a")
endfunction()

function(asip_add_image name)
  cmake_parse_arguments(arg "" "BOARD;SKETCH" "SOURCES;DEFINES" ${ARGN})
  asip_add_core(${arg_BOARD})
  asip_board_flags(${arg_BOARD} flags)
  list(TRANSFORM arg_DEFINES PREPEND -D)
  list(APPEND flags ${asip_avr_warnings} ${arg_DEFINES} -I${ASIP_LIBRARY_DIR})
  asip_add_library(${arg_BOARD} "${arg_DEFINES}" "${flags}" library)
  set(folder "${PROJECT_BINARY_DIR}/firmware/${name}")
  file(MAKE_DIRECTORY "${folder}" "${ASIP_IMAGES}")

  set(objects)
  foreach(source ${arg_SKETCH} ${arg_SOURCES})
    get_filename_component(source "${source}" ABSOLUTE)
    get_filename_component(base "${source}" NAME)
    asip_avr_object("${source}" "${folder}/${base}.o" ${flags})
    list(APPEND objects "${folder}/${base}.o")
  endforeach()

  set(core "${PROJECT_BINARY_DIR}/firmware/core_${arg_BOARD}/core.a")
  set(elf "${ASIP_IMAGES}/${name}.elf")
  list(FILTER flags INCLUDE REGEX "^-mmcu")
  add_custom_command(OUTPUT "${elf}"
    COMMAND avr-gcc -Os -g -flto -fuse-linker-plugin -Wl,--gc-sections ${flags} -o "${elf}"
      ${objects} "${library}" "${core}" -lm
    DEPENDS ${objects} "${library}" ${library_target} "${core}" avr_core_${arg_BOARD}
    COMMENT "image ${name}.elf" VERBATIM)
  add_custom_target(${name}_image ALL DEPENDS "${elf}")
  if(NOT TARGET firmware-images)
    add_custom_target(firmware-images)
  endif()
  add_dependencies(firmware-images ${name}_image)
endfunction()
