// SPDX-License-Identifier: Apache-2.0
#include "asip/session/submit_refusal.hpp"

namespace asip::session {

const char* to_string(Refusal refusal) {
    switch (refusal) {
        case Refusal::kInvalid:
        case Refusal::kTooLong:
            return "invalid";
        case Refusal::kQueueFull:
        case Refusal::kTooManyNames:
            return "queue-full";
        case Refusal::kNoBoard:
            return "board-not-there";
    }
    return "?";
}

}  // namespace asip::session
