#include "asip/client/error.hpp"

#include <utility>

namespace asip::client {

std::string to_string(const Error& error) {
    std::string kind;
    switch (error.kind) {
        case Error::Kind::Invalid:
            kind = "invalid";
            break;
        case Error::Kind::Refused:
            kind = "refused";
            break;
        case Error::Kind::Board:
            kind = "board error " + std::to_string(error.code);
            break;
        case Error::Kind::Timeout:
            kind = "timeout";
            break;
        case Error::Kind::Unreachable:
            kind = "unreachable";
            break;
        case Error::Kind::Closed:
            kind = "closed";
            break;
    }
    return error.text.empty() ? kind : kind + ": " + error.text;
}

Unexpected<Error> failure(Error::Kind kind, std::string text, int code) {
    return Unexpected<Error>(Error{kind, code, std::move(text)});
}

}  // namespace asip::client
