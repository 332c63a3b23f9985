// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/expected.hpp"

namespace asip::program {

/// From a file of `asipctl secure`.
struct Credentials {
    std::vector<std::string> brokers;
    std::string user;
    std::string password;
    std::string topic_root;    ///< empty: the default
    std::string name;          ///< of the board, where they are those of a board
    bool certificate = false;  ///< the file also holds the certificate of the authority, in PEM
};

/// Lines `NAME = VALUE` (`broker`, `user`, `password`, `topic-root`, `name`, `role`), `#` comments, and PEM
/// blocks. Fails, with file and line, on a file that is unreadable or above 1 MiB, another line, or without
/// `user`, `password` or `broker`.
Expected<Credentials> read_credentials(const std::string& path);

/// `source` is named in errors.
Expected<Credentials> parse_credentials(const std::string& text, const std::string& source);

}  // namespace asip::program
