// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <string_view>

#include "asip/expected.hpp"

namespace asip::generate {

// Names of a model are `[a-z][a-z0-9._-]*`; each language has its own form of them.

/// "stop-all" -> "StopAll".
std::string pascal_case(std::string_view name);

/// "stop-all" -> "stopAll"; a word that means something in C++ or to an Arduino core gets `_` behind it.
std::string camel_case(std::string_view name);

/// "stop-all" -> "stop_all".
std::string snake_case(std::string_view name);
/// The same; a word that means something in C++ gets `_` behind it.
std::string cpp_name(std::string_view name);

/// The names that share one scope of generated code. Two that became one are an error, not code that does
/// not compile.
class Scope {
  public:
    /// `language` is for messages: "C++".
    explicit Scope(std::string language) : language_(std::move(language)) {}

    /// Registers `name`, made of what the model calls `origin` ("command stop-all").
    void add(const std::string& name, const std::string& origin);
    /// The first clash: "command a-b and command a_b both become a_b in C++: rename one"; empty: none.
    const std::string& fault() const { return fault_; }

  private:
    std::string language_;
    std::map<std::string, std::string> origins_;
    std::string fault_;
};

/// Text for people, fit for the rest of a `//` comment: what would end the line, continue it, or show
/// the text in another order than the compiler reads it, is replaced.
std::string comment(std::string_view text);
/// As a character of C++: `'W'`, `'\''`.
std::string cpp_character(char c);
/// As a string of C++, with its quotes.
std::string string_literal(std::string_view text);

}  // namespace asip::generate
