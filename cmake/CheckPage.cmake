# SPDX-License-Identifier: Apache-2.0
# Checks that the files a page builds, block by block, are those of a folder:
#   cmake -DPAGE=docs/page.md -DFOLDER=firmware/examples/x -DFILES=a.h,a.cpp -P CheckPage.cmake
# A block belongs to the file named in the comment before it (file: NAME); blocks of one file follow each other with an
# empty line between them.

file(READ "${PAGE}" rest)
# Semicolons and brackets mean something to CMake's lists.
string(REPLACE ";" "<semicolon>" rest "${rest}")
string(REPLACE "," ";" FILES "${FILES}")
while(rest MATCHES "<!-- file: ([A-Za-z.]+) -->\n```[a-z]+\n")
  set(name "${CMAKE_MATCH_1}")
  string(FIND "${rest}" "${CMAKE_MATCH_0}" at)
  string(LENGTH "${CMAKE_MATCH_0}" length)
  math(EXPR at "${at} + ${length}")
  string(SUBSTRING "${rest}" ${at} -1 rest)
  string(FIND "${rest}" "```" end)
  string(SUBSTRING "${rest}" 0 ${end} block)
  if(DEFINED "text_${name}")
    string(APPEND "text_${name}" "\n")
  endif()
  string(APPEND "text_${name}" "${block}")
endwhile()
foreach(name IN LISTS FILES)
  if(WRITE)
    string(REPLACE "<semicolon>" ";" text "${text_${name}}")
    file(WRITE "${FOLDER}/${name}" "${text}")
  endif()
  file(READ "${FOLDER}/${name}" text)
  string(REPLACE ";" "<semicolon>" text "${text}")
  if(NOT text STREQUAL "${text_${name}}")
    message(FATAL_ERROR "${FOLDER}/${name} is not what ${PAGE} builds. Change one as the other, or write the file from the page:\n"
      "  cmake -DWRITE=1 -DPAGE=${PAGE} -DFOLDER=${FOLDER} -DFILES=${name} -P ${CMAKE_CURRENT_LIST_FILE}")
  endif()
endforeach()
