// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {

/// An object of JSON as text, written member by member. A start beside a thousand boards writes a thousand
/// documents of a hundred members each; a tree of each would cost several times what its text costs.
class ObjectText {
  public:
    /// `name` needs no escapes.
    ObjectText& add(std::string_view name, std::string_view text) {
        begin(name);
        const bool plain = std::all_of(text.begin(), text.end(),
                                       [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
        if (plain)
            text_.append(1, '"').append(text).append(1, '"');
        else
            text_ += model::dump_json(nlohmann::json(text));
        return *this;
    }
    ObjectText& add_value(std::string_view name, const nlohmann::json& value) {
        return add_json(name, model::dump_json(value));
    }
    /// A value that is JSON already.
    ObjectText& add_json(std::string_view name, std::string_view value) {
        begin(name);
        text_ += value;
        return *this;
    }
    bool empty() const { return text_.size() == 1; }
    /// The whole object. Nothing can be added any more.
    std::string end() {
        text_ += '}';
        return std::move(text_);
    }

  private:
    void begin(std::string_view name) {
        if (!empty()) text_ += ',';
        text_.append(1, '"').append(name).append("\":");
    }

    std::string text_ = "{";
};

}  // namespace asip::gateway::exports
