// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "gateway/auth/rights.hpp"

namespace asip::gateway {

/// The tokens file: lines `ROLE NAME HASH [until=TIME] [boards=A,B] [services=C] [frames=ORIGIN]
/// [dashboard=NAME [control=yes]]`, `#` comments. Only hashes are kept. A value: it does not follow the file.
/// Pointers that it gives are valid as long as it is not assigned to.
class Tokens {
  public:
    /// Fails with the line's number and a sentence; two tokens of one name are a fault.
    static Expected<Tokens> parse(std::string_view text);
    static Expected<Tokens> read(const std::string& path);
    /// The text of a tokens file. Fails with a sentence that names the file, also where it is no file or
    /// longer than 1 MiB.
    static Expected<std::string> text_of(const std::string& path);
    /// A name that no token may have: it is of those without one.
    static bool is_reserved(std::string_view name);

    /// Null: no such token. Each is compared in full and in constant time. Whether it has expired is the
    /// caller's to judge.
    const Rights* find(std::string_view token) const;
    const Rights* named(std::string_view name) const;
    const std::vector<Rights>& all() const { return tokens_; }

  private:
    std::vector<Rights> tokens_;
};

/// The line of the file for a new token, without a line end; parse() reads it back as these rights.
std::string token_line(const Rights& rights, std::string_view hash);

}  // namespace asip::gateway
