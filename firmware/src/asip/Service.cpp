#include "Service.h"

#include "Board.h"

namespace asip {

void Service::reportValue(uint8_t) {}

void Service::reportValues() {
    board.sendList(*this, 'e', count_);
}

void Service::poll() {}

// True when due, and then until reloaded: a report that finds the line busy comes a little later.
bool Service::countDown(uint8_t elapsedMs) {
    if (period_ == 0) return false;
    remaining_ = remaining_ > elapsedMs ? static_cast<uint16_t>(remaining_ - elapsedMs) : 0;
    return remaining_ == 0;
}

}  // namespace asip
