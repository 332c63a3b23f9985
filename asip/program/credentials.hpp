// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::program {

/// What one file of `asipctl secure` gives to a program.
struct Credentials {
    std::vector<std::string> brokers;
    std::string user;
    std::string password;
    std::string topic_root;    ///< empty: the default
    std::string name;          ///< of the board, where they are those of a board
    bool certificate = false;  ///< the file also holds the certificate of the authority, in PEM
};

/// Reads lines `NAME = VALUE` with the names `broker` (several, with commas), `user`, `password`,
/// `topic-root`, `name` and `role` (for people), `#` comments, and PEM blocks. Fails, with file and line,
/// on a file that cannot be read or is larger than 1 MiB, a line of another form, and one without `user`,
/// `password` or `broker`.
Expected<Credentials> read_credentials(const std::string& path);

/// The same of a text; `source` is named in errors.
Expected<Credentials> parse_credentials(const std::string& text, const std::string& source);

}  // namespace asip::program
