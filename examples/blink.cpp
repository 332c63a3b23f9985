// SPDX-License-Identifier: Apache-2.0
// Blinks the LED of a board, in blocking calls.
//
//     blink [ADDRESS [PIN [TIMES]]]
//
// ADDRESS is a serial port (/dev/ttyACM0), a TCP address (tcp://host:6789) or a board of a broker
// (mqtt://broker/uno1, or just uno1 for the broker on this machine). Default: /dev/ttyACM0, pin 13, for ever.

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "asip/client/blocking_board.hpp"

using asip::client::BlockingBoard;
using asip::protocol::PinMode;
using namespace std::chrono_literals;

int main(int argc, char** argv) {
    const std::string address = argc > 1 ? argv[1] : "/dev/ttyACM0";
    const int pin = argc > 2 ? std::atoi(argv[2]) : 13;
    const int times = argc > 3 ? std::atoi(argv[3]) : 0;

    auto board = BlockingBoard::open(address);
    if (!board) {
        std::fprintf(stderr, "blink: %s: %s\n", address.c_str(), to_string(board.error()).c_str());
        return 1;
    }
    if (const auto set = board->set_pin_mode(pin, PinMode::kOutput); !set) {
        std::fprintf(stderr, "blink: pin %d: %s\n", pin, to_string(set.error()).c_str());
        return 1;
    }
    for (int i = 0; times == 0 || i < times; ++i) {
        for (const bool level : {true, false}) {
            if (const auto written = board->digital_write(pin, level); !written) {
                std::fprintf(stderr, "blink: %s\n", to_string(written.error()).c_str());
            }
            std::this_thread::sleep_for(500ms);
        }
    }
    return 0;
}
