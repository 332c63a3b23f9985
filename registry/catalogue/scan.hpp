#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace asip::registry {

/// A description's members at the first level; the texts are views into the payload.
struct Scan {
    std::string_view board;
    std::string_view session;
    std::uint64_t seq = 0;
    std::uint64_t lease = 0;  // seconds; 0: not said
    std::string_view firmware;
    std::string_view pins;
    std::string_view services;
    std::string_view agent;
    std::string_view link;
    std::string extra;  // members that we do not know, as they came, joined by commas
};

/// Texts that members are likely to have; a member that begins with its guess is not read again.
struct Guesses {
    std::string_view firmware;
    std::string_view pins;
    std::string_view services;
    std::string_view agent;
    std::string_view link;
};

/// False if `payload` is not a JSON object with board, session, seq and services of the right types, or has
/// one of our members twice. Names are not checked here.
bool scan_description(std::string_view payload, const Guesses& guesses, Scan& scan);

}  // namespace asip::registry
