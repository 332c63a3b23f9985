// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/render.hpp"

#include <algorithm>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace asip::generate {
namespace {

using kainjow::mustache::data;

data to_data(const nlohmann::json& value) {
    if (value.is_boolean()) return data(value.get<bool>() ? data::type::bool_true : data::type::bool_false);
    if (value.is_string()) return data(value.get<std::string>());
    if (value.is_array()) {
        data list(data::type::list);
        for (const auto& item : value)
            list.push_back(to_data(item));
        return list;
    }
    if (value.is_object()) {
        data object(data::type::object);
        for (const auto& [name, member] : value.items())
            object.set(name, to_data(member));
        return object;
    }
    return data(value.dump());
}

// The library drops a line that is empty behind a tag. This character is taken out at the end.
constexpr char kEmptyLine = '\x01';

/// A line with nothing but the tag of a section leaves nothing, whether the section is shown or not.
std::string without_tag_lines(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const auto end = std::min(text.find('\n'), text.size() - 1);
        const auto line = text.substr(0, end);
        const bool is_tag = line.size() > 5 && line.starts_with("<%") && line.find("%>") == line.size() - 2 &&
                            std::string_view("#^/").find(line[2]) != std::string_view::npos;
        if (line.empty()) result += kEmptyLine;
        result += is_tag ? line : text.substr(0, end + 1);
        text.remove_prefix(end + 1);
    }
    return result;
}

}  // namespace

std::string render(std::string_view text, const nlohmann::json& view) {
    kainjow::mustache::mustache file("{{=<% %>=}}" + without_tag_lines(text));
    file.set_custom_escape([](const std::string& plain) { return plain; });
    if (!file.is_valid()) throw std::logic_error("template: " + file.error_message());
    auto result = file.render(to_data(view));
    std::erase(result, kEmptyLine);
    return result;
}

}  // namespace asip::generate
