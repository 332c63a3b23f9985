// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/caller/caller.hpp"

namespace asip::caller {

struct Caller::Call::Entry {
    std::string topic, silence;
    Done done;  // empty: all was told
    Time sent{};
    bool late = false;
    bool ended = false;  // an answer was told
    bus::Requester::Request request{};
    bool no_room = false;  // it was not sent

    bool waits() const { return done && !ended; }
};

struct Caller::Hold::Entry {
    std::string topic;
    std::chrono::milliseconds hold;
    Done begun, ended;
    Call call{};
    std::string id{};  // of the command
    bus::Requester::Request renewal{};
    std::optional<Time> next{};  // renewal; none: it has not begun, or has ended
};

}  // namespace asip::caller
