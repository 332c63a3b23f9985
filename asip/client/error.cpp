// SPDX-License-Identifier: Apache-2.0
#include "asip/client/error.hpp"

#include <utility>

namespace asip::client {

std::string to_string(const Error& error) {
    std::string kind;
    switch (error.kind) {
        case Error::Kind::kInvalid:
            kind = "invalid";
            break;
        case Error::Kind::kRefused:
            kind = "refused";
            break;
        case Error::Kind::kBoard:
            kind = "board error " + std::to_string(error.code);
            break;
        case Error::Kind::kTimeout:
            kind = "timeout";
            break;
        case Error::Kind::kUnreachable:
            kind = "unreachable";
            break;
        case Error::Kind::kClosed:
            kind = "closed";
            break;
    }
    return error.text.empty() ? kind : kind + ": " + error.text;
}

Unexpected<Error> failure(Error::Kind kind, std::string text, int code) {
    return Unexpected<Error>(Error{kind, code, std::move(text)});
}

}  // namespace asip::client
