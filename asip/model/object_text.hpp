// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "asip/model/json.hpp"

namespace asip::model {

/// A JSON object, written member by member into a text that it shares with those around it, until its scope
/// ends. A tree would cost several times as much.
class ObjectText {
  public:
    explicit ObjectText(std::string& text) : text_(text) { text_ += '{'; }
    ~ObjectText() { text_ += '}'; }
    ObjectText(const ObjectText&) = delete;
    ObjectText& operator=(const ObjectText&) = delete;

    ObjectText& add(std::string_view name, std::string_view text) {
        begin(name);
        append(text);
        return *this;
    }
    /// Null where JSON has no such number.
    ObjectText& add_number(std::string_view name, double value) {
        begin(name);
        constexpr double kExact = 9e15;
        char digits[32];
        if (!std::isfinite(value))
            text_ += "null";
        else if (std::floor(value) == value && std::abs(value) < kExact)
            text_.append(digits,
                         std::to_chars(digits, std::end(digits), static_cast<std::int64_t>(value)).ptr);
        else
            text_.append(digits, std::to_chars(digits, std::end(digits), value).ptr);
        return *this;
    }
    /// `value` is JSON.
    ObjectText& add_json(std::string_view name, std::string_view value) {
        begin(name);
        text_ += value;
        return *this;
    }
    ObjectText& add_bool(std::string_view name, bool value) {
        return add_json(name, value ? "true" : "false");
    }
    template <class Words>
    ObjectText& add_words(std::string_view name, const Words& words) {
        begin(name);
        char before = '[';
        for (const auto& word : words) {
            text_ += before;
            append(word);
            before = ',';
        }
        text_ += before == '[' ? "[]" : "]";
        return *this;
    }
    /// Nothing else is added until that object ends.
    ObjectText object(std::string_view name) {
        begin(name);
        return ObjectText(text_);
    }

  private:
    void begin(std::string_view name) {
        if (text_.back() != '{') text_ += ',';
        append(name);
        text_ += ':';
    }
    void append(std::string_view text) {
        const bool plain = std::all_of(text.begin(), text.end(),
                                       [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
        if (plain)
            text_.append(1, '"').append(text).append(1, '"');
        else
            text_ += dump_json(nlohmann::json(text));
    }

    std::string& text_;
};

}  // namespace asip::model
