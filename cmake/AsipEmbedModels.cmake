# SPDX-License-Identifier: Apache-2.0
# Script: turns services/*.json into a C++ source. -DOUTPUT=file.cpp -DSCHEMA=schema.json -DMODELS=a.json;b.json
# Texts go in as raw strings, cut into pieces because a compiler need not take one literal above 64 KiB.

function(append_literal path)
  file(READ "${path}" text)
  string(LENGTH "${text}" length)
  if(length GREATER 60000)
    message(FATAL_ERROR "${path} is too long to be built in")
  endif()
  string(APPEND content "R\"asip_json(${text})asip_json\"")
  set(content "${content}" PARENT_SCOPE)
endfunction()

set(content "// Generated from services/.\n#include \"asip/model/embedded.hpp\"\n\n#include <array>\n\nnamespace asip::model {\n\n")
string(APPEND content "std::string_view embedded_schema() {\n    return ")
append_literal("${SCHEMA}")
string(APPEND content ";\n}\n\n")
list(LENGTH MODELS count)
string(APPEND content "std::span<const std::pair<std::string_view, std::string_view>> embedded_models() {\n")
string(APPEND content "    static constexpr std::array<std::pair<std::string_view, std::string_view>, ${count}> models = {{\n")
foreach(model IN LISTS MODELS)
  get_filename_component(name "${model}" NAME_WE)
  string(APPEND content "        {\"${name}\", ")
  append_literal("${model}")
  string(APPEND content "},\n")
endforeach()
string(APPEND content "    }};\n    return models;\n}\n\n}  // namespace asip::model\n")
file(WRITE "${OUTPUT}" "${content}")
