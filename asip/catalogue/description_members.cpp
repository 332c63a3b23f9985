// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/description_members.hpp"

#include <charconv>
#include <cstring>

#include "asip/bus/json/json_scanner.hpp"

namespace asip::catalogue {
namespace {

using bus::JsonScanner;

/// As `==`, with a length that the compiler knows: each description has a dozen keys, each of which is
/// compared with a dozen names.
template <std::size_t Size>
bool is(std::string_view key, const char (&name)[Size]) {
    return key.size() == Size - 1 && std::memcmp(key.data(), name, Size - 1) == 0;
}

bool read_structure(JsonScanner& in, std::string_view guess, char open, std::string_view& text) {
    if (in.known_value(guess)) {
        text = guess;
        return true;
    }
    return in.value(text) && text.front() == open;
}

bool read_number(std::string_view text, double& number) {
    const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
    return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

bool read_state(std::string_view text, std::optional<model::SaidState>& state) {
    JsonScanner in(text);
    if (!in.enter_object()) return false;
    model::SaidState said;
    std::optional<model::BoardState> word;
    std::string_view key;
    std::string_view value;
    while (in.next_member(key)) {
        if (is(key, "is") || is(key, "reason")) {
            if (!in.plain_string(value)) return false;
            if (is(key, "is")) word = model::board_state_from_text(value);
            if (is(key, "reason")) said.reason = model::state_reason_from_text(value);
        } else {
            if (!in.value(value)) return false;
            if (is(key, "age") &&
                !(read_number(value, said.age) && said.age >= 0 && said.age <= model::kMaxStateAgeSeconds))
                return false;
        }
    }
    if (!in.left() || !word) return false;
    said.state = *word;
    state = said;
    return true;
}

bool read_member(JsonScanner& in, std::string_view key, const Guesses& guesses, DescriptionMembers& members,
                 unsigned& seen) {
    enum : unsigned {
        kBoard = 1,
        kSession = 2,
        kSeq = 4,
        kLease = 8,
        kFirmware = 16,
        kPins = 32,
        kServices = 64,
        kAgent = 128,
        kLink = 256,
        kLabels = 512,
        kNames = 1024,
        kState = 2048
    };
    const auto once = [&seen](unsigned bit) { return (seen & bit) == 0 && (seen |= bit) != 0; };
    if (is(key, "board")) return once(kBoard) && in.plain_string(members.board);
    if (is(key, "session")) return once(kSession) && in.plain_string(members.session);
    if (is(key, "seq")) return once(kSeq) && in.unsigned_integer(members.seq);
    if (is(key, "lease")) return once(kLease) && in.unsigned_integer(members.lease);
    if (is(key, "firmware"))
        return once(kFirmware) && read_structure(in, guesses.firmware, '{', members.firmware);
    if (is(key, "pins")) return once(kPins) && read_structure(in, guesses.pins, '{', members.pins);
    if (is(key, "services"))
        return once(kServices) && read_structure(in, guesses.services, '[', members.services);
    if (is(key, "agent")) return once(kAgent) && read_structure(in, guesses.agent, '{', members.agent);
    if (is(key, "link")) return once(kLink) && read_structure(in, guesses.link, '{', members.link);
    std::string_view value;
    if (!in.value(value)) return false;
    if (is(key, "state")) return once(kState) && read_state(value, members.state);
    if (is(key, "labels") && !once(kLabels)) return false;
    if (is(key, "names") && !once(kNames)) return false;
    if (is(key, "labels")) members.labels = value;
    if (is(key, "names")) members.names = value;
    if (!members.extra.empty()) members.extra += ',';
    members.extra.append("\"").append(in.raw_key()).append("\":").append(value);
    return true;
}

}  // namespace

bool read_description(std::string_view payload, const Guesses& guesses, DescriptionMembers& members) {
    constexpr unsigned kNeeded = 1 | 2 | 4 | 64;  // board, session, seq, services
    JsonScanner in(payload);
    if (!in.enter_object()) return false;
    unsigned seen = 0;
    std::string_view key;
    while (in.next_member(key)) {
        if (!read_member(in, key, guesses, members, seen)) return false;
    }
    return in.left() && in.at_end() && (seen & kNeeded) == kNeeded;
}

}  // namespace asip::catalogue
