// SPDX-License-Identifier: Apache-2.0
// A button on one board switches an LED on another. Neither board knows of the other, and each may be on a
// serial port, behind TCP or anywhere on a broker: the program is the same.
//
//     two_board_switch BUTTON_BOARD LED_BOARD [BUTTON_PIN [LED_PIN]]
//     two_board_switch mqtt://broker/uno1 mqtt://broker/uno2 2 13
//
// The button connects its pin to ground; the board's own pull-up keeps the pin high while it is not pressed.

#include "asip/client/board.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>

using asip::client::Awaitable;
using asip::client::Board;
using asip::client::Error;
using asip::client::Result;
using asip::protocol::PinMode;

namespace {

struct Wiring {
    std::string button_board;
    std::string led_board;
    int button_pin = 2;
    int led_pin = 13;
};

void report(const std::exception_ptr&, const Result<void>& lit) {
    if (!lit) std::fprintf(stderr, "two_board_switch: %s\n", to_string(lit.error()).c_str());
}

Awaitable<void> run_switch(boost::asio::io_context& io, Wiring wiring) {
    const auto button = co_await Board::open(io, wiring.button_board);
    if (!button) {
        co_return asip::Unexpected<Error>(button.error());
    }
    const auto led = co_await Board::open(io, wiring.led_board);
    if (!led) {
        co_return asip::Unexpected<Error>(led.error());
    }
    if (auto set = co_await led->set_pin_mode(wiring.led_pin, PinMode::kOutput); !set) {
        co_return set;
    }
    const auto changes = button->digital_changes(wiring.button_pin);  // from here on, no press is missed
    if (auto set = co_await button->set_pin_mode(wiring.button_pin, PinMode::kInputPullup); !set) {
        co_return set;
    }
    std::printf("pin %d of %s switches pin %d of %s\n", wiring.button_pin, button->name().c_str(),
                wiring.led_pin, led->name().c_str());
    std::fflush(stdout);
    // A board that was replugged or restarted has its outputs off: the LED is set again when it is back. Of
    // the button the board reports the level anew, which comes as a change.
    std::optional<bool> wanted;
    const auto set_again = led->on_presence([&io, &wanted, led = *led, pin = wiring.led_pin](bool there) {
        if (there && wanted) boost::asio::co_spawn(io, led.digital_write(pin, *wanted), report);
    });
    while (true) {
        const auto released = co_await changes.next();
        if (!released) {
            co_return asip::Unexpected<Error>(released.error());
        }
        wanted = !*released;
        report(nullptr, co_await led->digital_write(wiring.led_pin, *wanted));  // it may be away for a while
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: two_board_switch BUTTON_BOARD LED_BOARD [BUTTON_PIN [LED_PIN]]\n");
        return 2;
    }
    const Wiring wiring{argv[1], argv[2], argc > 3 ? std::atoi(argv[3]) : 2,
                        argc > 4 ? std::atoi(argv[4]) : 13};
    std::signal(SIGPIPE, SIG_IGN);  // a broker that goes is an error of a call
    boost::asio::io_context io;
    int status = 0;
    boost::asio::co_spawn(io, run_switch(io, wiring), [&](std::exception_ptr, const Result<void>& ended) {
        if (!ended) {
            std::fprintf(stderr, "two_board_switch: %s\n", to_string(ended.error()).c_str());
            status = 1;
        }
    });
    io.run();
    return status;
}
