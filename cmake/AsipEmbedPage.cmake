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
  set(tools make_page join_scripts.awk name_texts.awk shorten_script.awk shorten_style.sed)
  list(TRANSFORM tools PREPEND "${CMAKE_SOURCE_DIR}/cmake/")
  add_custom_command(OUTPUT "${output}"
    COMMAND ${CMAKE_COMMAND} "-DFOLDER=${folder}" "-DOUTPUT=${output}" -P "${ASIP_EMBED_PAGE_SCRIPT}"
    DEPENDS ${paths} "${folder}/files.txt" "${ASIP_EMBED_PAGE_SCRIPT}" ${tools}
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
execute_process(COMMAND "${CMAKE_CURRENT_LIST_DIR}/make_page" "${FOLDER}" "${OUTPUT}.made" RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "cannot compress ${FOLDER}")
endif()
file(STRINGS "${OUTPUT}.made/files" NAMES)
foreach(name IN LISTS NAMES)
  set(made "${OUTPUT}.made/${name}.gz")
  file(READ "${made}" hex HEX)
  file(SHA256 "${made}" hash)
  string(SUBSTRING "${hash}" 0 16 hash)
  string(LENGTH "${hex}" length)
  math(EXPR bytes "${length} / 2")
  math(EXPR total "${total} + ${bytes}")
  string(REGEX REPLACE "(..)" "0x\\1," array "${hex}")
  string(APPEND content "constexpr unsigned char kFile${count}[] = {${array}};\n")
  string(APPEND entries "    PageFile{\"${name}\", {reinterpret_cast<const char*>(kFile${count}), sizeof kFile${count}}, \"${hash}\"},\n")
  math(EXPR count "${count} + 1")
endforeach()
file(REMOVE_RECURSE "${OUTPUT}.made")
string(APPEND content "\n}  // namespace\n\n// ${total} bytes in all.\nstd::span<const PageFile> page_files() {\n")
string(APPEND content "    static const std::array<PageFile, ${count}> files{{\n${entries}    }};\n    return files;\n}\n\n}  // namespace asip::gateway\n")
file(WRITE "${OUTPUT}" "${content}")
