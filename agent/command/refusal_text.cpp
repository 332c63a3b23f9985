// SPDX-License-Identifier: Apache-2.0
#include "agent/command/refusal_text.hpp"

#include "asip/bus/request/reply.hpp"

namespace asip::agent {

std::string refusal_text(session::Refusal refusal) {
    switch (refusal) {
        case session::Refusal::kQueueFull:
            return "too many commands wait for the board; send fewer, or wait for answers";
        case session::Refusal::kNoBoard:
            return "the board is not there now";
        case session::Refusal::kTooLong:
            return "the request is longer than the board takes; send it in parts";
        case session::Refusal::kTooManyNames:
            return "this board was given a name too often: its memory wears out. One more is taken in 10 "
                   "minutes";
        case session::Refusal::kInvalid:
            return "not a request that may be sent to the board";
    }
    return {};
}

std::string_view reason_of(const session::Finished& end) {
    switch (end.not_sent) {
        case session::NotSent::kDeadline:
            return bus::kRefusedDeadline;
        case session::NotSent::kStopped:
            return bus::kRefusedStopped;
        case session::NotSent::kBoardGone:
            break;
    }
    return bus::kRefusedBoardNotThere;
}

std::string not_sent_text(const session::Finished& end) {
    switch (end.not_sent) {
        case session::NotSent::kDeadline:
            return "its time was over before the board could be given it; it was not sent";
        case session::NotSent::kStopped:
            return "the board was stopped while it waited; it was not sent";
        case session::NotSent::kBoardGone:
            break;
    }
    return refusal_text(session::Refusal::kNoBoard);
}

}  // namespace asip::agent
