# SPDX-License-Identifier: Apache-2.0
# Script: turns text files into a C++ source with `std::string_view FUNCTION(std::string_view name)`, which finds one by its
# name without its last extension and throws std::logic_error where there is none. -DOUTPUT=file.cpp -DHEADER=the/header.hpp -DNAMESPACE=a::b
# -DFUNCTION=name -DFILES=a;b
set(content "// Generated.\n#include \"${HEADER}\"\n\n#include <array>\n#include <stdexcept>\n#include <utility>\n\nnamespace ${NAMESPACE} {\n\n")
list(LENGTH FILES count)
string(APPEND content "std::string_view ${FUNCTION}(std::string_view name) {\n")
string(APPEND content "    static constexpr std::array<std::pair<std::string_view, std::string_view>, ${count}> files = {{\n")
foreach(file IN LISTS FILES)
  get_filename_component(name "${file}" NAME_WLE)
  file(READ "${file}" text)
  string(LENGTH "${text}" length)
  if(length GREATER 60000)
    message(FATAL_ERROR "${file} is too long to be built in")
  endif()
  string(APPEND content "        {\"${name}\", R\"asip_text(${text})asip_text\"},\n")
endforeach()
string(APPEND content "    }};\n    for (const auto& [known, text] : files)\n        if (known == name) return text;\n")
string(APPEND content "    throw std::logic_error(\"there is no text \" + std::string(name));\n}\n\n}  // namespace ${NAMESPACE}\n")
file(WRITE "${OUTPUT}" "${content}")
