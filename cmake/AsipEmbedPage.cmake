# SPDX-License-Identifier: Apache-2.0
# Builds the files of a web page into a program, compressed. files.txt in the folder lists them, one path a line, relative
# to the folder; `#` begins a comment. Run as a script it writes the source.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(ASIP_EMBED_PAGE_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")
endif()

# asip_embed_page(FOLDER OUTPUT.cpp)
function(asip_embed_page folder output)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${folder}/files.txt")
  file(STRINGS "${folder}/files.txt" names REGEX "^[^#]")
  list(TRANSFORM names PREPEND "${folder}/" OUTPUT_VARIABLE paths)
  list(JOIN names "," joined)
  add_custom_command(OUTPUT "${output}"
    COMMAND ${CMAKE_COMMAND} "-DFOLDER=${folder}" "-DNAMES=${joined}" "-DOUTPUT=${output}" -P "${ASIP_EMBED_PAGE_SCRIPT}"
    DEPENDS ${paths} "${folder}/files.txt" "${ASIP_EMBED_PAGE_SCRIPT}" "${CMAKE_SOURCE_DIR}/cmake/name_texts.awk" "${CMAKE_SOURCE_DIR}/cmake/shorten_script.awk" "${CMAKE_SOURCE_DIR}/cmake/shorten_style.sed"
    COMMENT "Building the web page in" VERBATIM)
endfunction()

if(NOT CMAKE_SCRIPT_MODE_FILE)
  return()
endif()

set(content "// Generated from the files of the web page.\n#include \"gateway/page_files.hpp\"\n\n#include <array>\n\n")
string(APPEND content "namespace asip::gateway {\nnamespace {\n\n")
set(entries "")
set(count 0)
set(total 0)
string(REPLACE "," ";" NAMES "${NAMES}")
foreach(name IN LISTS NAMES)
  # Without comments and blanks that say nothing, an eighth of the whole.
  set(shorten cat)
  if(name MATCHES "[.]js$")
    set(shorten awk -f "${CMAKE_CURRENT_LIST_DIR}/shorten_script.awk")
  elseif(name MATCHES "[.]css$")
    set(shorten sed -E -f "${CMAKE_CURRENT_LIST_DIR}/shorten_style.sed")
  endif()
  set(name_texts cat)
  if(name MATCHES "[.](js|html|json)$")
    set(name_texts awk -f "${CMAKE_CURRENT_LIST_DIR}/name_texts.awk" "${FOLDER}/languages/en.json")
  endif()
  # -n: without name and time, so that the same file gives the same bytes.
  execute_process(COMMAND env LC_ALL=C ${name_texts} "${FOLDER}/${name}" COMMAND env LC_ALL=C ${shorten} COMMAND gzip -9 -n -c OUTPUT_FILE "${OUTPUT}.gz" RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "cannot compress ${FOLDER}/${name}")
  endif()
  file(READ "${OUTPUT}.gz" hex HEX)
  file(SHA256 "${OUTPUT}.gz" hash)
  string(SUBSTRING "${hash}" 0 16 hash)
  string(LENGTH "${hex}" length)
  math(EXPR bytes "${length} / 2")
  math(EXPR total "${total} + ${bytes}")
  string(REGEX REPLACE "(..)" "0x\\1," array "${hex}")
  string(APPEND content "constexpr unsigned char kFile${count}[] = {${array}};\n")
  string(APPEND entries "    PageFile{\"${name}\", {reinterpret_cast<const char*>(kFile${count}), sizeof kFile${count}}, \"${hash}\"},\n")
  math(EXPR count "${count} + 1")
endforeach()
file(REMOVE "${OUTPUT}.gz")
string(APPEND content "\n}  // namespace\n\n// ${total} bytes in all.\nstd::span<const PageFile> page_files() {\n")
string(APPEND content "    static const std::array<PageFile, ${count}> files{{\n${entries}    }};\n    return files;\n}\n\n}  // namespace asip::gateway\n")
file(WRITE "${OUTPUT}" "${content}")
