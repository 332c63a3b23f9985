// SPDX-License-Identifier: Apache-2.0
#include "Service.h"

#include "Board.h"

namespace asip {

void Service::reportValue(uint8_t) {}

void Service::reportValues() {
    board.sendList(*this, 'e', count());
}

void Service::poll() {}

// Counts on from the moment when a report was due, not from when it came out: it keeps its pace.
void Service::countDown(uint8_t elapsedMs) {
    const uint16_t period = period_;
    if (period == 0) return;
    uint16_t remaining = remaining_;
    if (remaining <= elapsedMs) {
        setDue(true);
        const uint8_t late = static_cast<uint8_t>(elapsedMs - remaining);
        remaining = late < period ? period : static_cast<uint16_t>(late + 1);
        elapsedMs = late;
    }
    remaining_ = static_cast<uint16_t>(remaining - elapsedMs);
}

}  // namespace asip
