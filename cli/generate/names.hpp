// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <string_view>

namespace asip::generate {

// Names of a model are `[a-z][a-z0-9._-]*`; each language has its own form of them.

/// "stop-all" -> "StopAll".
std::string pascal_case(std::string_view name);

/// "stop-all" -> "stopAll"; a reserved word of C++ or Arduino gets `_` behind it.
std::string camel_case(std::string_view name);

/// "stop-all" -> "stop_all".
std::string snake_case(std::string_view name);
/// The same; a reserved word of C++ gets `_` behind it.
std::string cpp_name(std::string_view name);

/// Names of one scope of generated code. Two that became one are an error.
class Scope {
  public:
    /// For messages: "C++".
    explicit Scope(std::string language) : language_(std::move(language)) {}

    /// `origin`: the model's name ("command stop-all").
    void add(const std::string& name, const std::string& origin);
    /// The first clash: "command a-b and command a_b both become a_b in C++: rename one"; may be empty.
    const std::string& fault() const { return fault_; }

  private:
    std::string language_;
    std::map<std::string, std::string> origins_;
    std::string fault_;
};

/// For the rest of a `//` comment: what would end or continue the line, or show it in another order, is
/// replaced.
std::string comment(std::string_view text);
/// `'W'`, `'\''`.
std::string cpp_character(char c);
/// With its quotes.
std::string string_literal(std::string_view text);

}  // namespace asip::generate
