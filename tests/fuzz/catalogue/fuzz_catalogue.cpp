// SPDX-License-Identifier: Apache-2.0
// Any sequence of messages and times: the catalogue's invariants hold, what it puts out can be encoded and
// read back.
//
// The input is a sequence of messages, each: a byte of kind, a byte of flags and board, a byte of seconds
// that pass, the payload up to a zero byte.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "asip/catalogue/catalogue.hpp"
#include "asip/text/wall_time.hpp"
#include "tests/support/catalogue_check.hpp"

namespace {

using namespace asip;
using bus::TopicKind;

constexpr TopicKind kKinds[] = {TopicKind::kDescription, TopicKind::kState, TopicKind::kBoardNames,
                                TopicKind::kServiceNames, TopicKind::kBoardOut};
constexpr std::string_view kBoards[] = {"uno1", "uno2", "esp", "registry"};

void require(bool condition) {
    if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view input(reinterpret_cast<const char*>(data), size);
    catalogue::Catalogue catalogue({.forget_after = std::chrono::seconds(300), .max_boards = 6});
    Time now = Time{} + std::chrono::hours(1);
    while (input.size() >= 3) {
        const auto kind = static_cast<std::uint8_t>(input[0]);
        const auto flags = static_cast<std::uint8_t>(input[1]);
        now += std::chrono::seconds(static_cast<std::uint8_t>(input[2]));
        input.remove_prefix(3);
        const std::string_view payload = input.substr(0, input.find('\0'));
        input.remove_prefix(std::min(input.size(), payload.size() + 1));

        catalogue::Announcement message;
        message.kind = kKinds[kind % std::size(kKinds)];
        message.board = kBoards[flags % std::size(kBoards)];
        message.payload = payload;
        message.retained = (flags & 4) != 0;
        if ((flags & 8) != 0) message.expiry_seconds = flags;
        if ((flags & 16) != 0) catalogue.expire(now);
        if ((flags & 32) != 0) catalogue.suspend();
        if ((flags & 64) != 0) catalogue.resume(now);
        if ((flags & 128) != 0) catalogue.settle();
        catalogue.apply(message, now);
        require(catalogue::CatalogueCheck::check(catalogue).empty());
    }
    bus::Query query;
    query.full = true;
    const auto answer = catalogue.find(query, {now, text::WallTime{}});
    require(answer.has_value());
    const auto again = bus::parse_answer(bus::encode(*answer));
    require(again.has_value() && again->boards.size() == catalogue.size());
    return 0;
}
