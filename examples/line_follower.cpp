// SPDX-License-Identifier: Apache-2.0
// Drives a two-wheeled robot (firmware/examples/AsipMirto) along a dark line. The board may be on a serial
// port, behind TCP or anywhere on a broker: the program is the same.
//
//     line_follower mqtt://broker/mirto
//     line_follower /dev/ttyACM0 --power 75 --kp 0.05 --ki 0.0001 --kd 1.6 --period 30 --cutoff 40
//
// docs/robot.md tries it on a simulated robot.

#include "asip/client/board.hpp"

#include <CLI/CLI.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "line_controller.hpp"

using asip::client::Awaitable;
using asip::client::Board;
using asip::client::Error;
using asip::client::Result;
using nlohmann::json;

namespace {

struct Settings {
    std::string board;
    LineGains gains;
    int period_ms = 50;
};

// The newest event; those that came while the last command was under way are old news.
Awaitable<json> newest(const asip::client::Stream<json>& events) {
    auto event = co_await events.next(std::chrono::seconds(2));
    while (event) {
        auto later = co_await events.next(std::chrono::seconds(0));
        if (!later) {
            break;
        }
        event = std::move(later);
    }
    co_return event;
}

Awaitable<void> follow(boost::asio::io_context& io, const Settings& settings, Board& board,
                       const bool& stopping) {
    asip::client::Options options;
    options.command_timeout = std::chrono::milliseconds(500);
    options.max_baud = 500'000;
    const auto opened = co_await Board::open(io, settings.board, options);
    if (!opened) {
        co_return asip::Unexpected<Error>(opened.error());
    }
    board = *opened;
    const auto sensors = board.service("reflectance");
    const auto motors = board.service("motors");
    if (!sensors || !motors) {
        co_return asip::Unexpected<Error>(!sensors ? sensors.error() : motors.error());
    }
    const auto events = sensors->events();
    const json period = json::array({settings.period_ms});
    if (auto asked = co_await sensors->command("report", period); !asked) {
        co_return asip::Unexpected<Error>(asked.error());
    }
    std::printf("%s follows the line\n", board.name().c_str());
    std::fflush(stdout);
    LineController controller(settings.gains);
    while (!stopping) {
        const auto event = co_await newest(events);
        if (!event) {
            std::fprintf(stderr, "line_follower: %s\n", to_string(event.error()).c_str());
            continue;
        }
        const auto values = event->value("reflectance", std::vector<int>());
        if (values.size() != 3) {
            continue;
        }
        const json powers = controller.drive({values[0], values[1], values[2]});
        if (auto driven = co_await motors->command("drive", powers); !driven) {
            std::fprintf(stderr, "line_follower: %s\n", to_string(driven.error()).c_str());
        }
    }
    const auto stopped = co_await motors->command("stop-all");
    const json never = json::array({0});
    co_await sensors->command("report", never);
    co_return stopped ? Result<void>() : Result<void>(asip::Unexpected<Error>(stopped.error()));
}

int read_settings(CLI::App& app, Settings& settings, int argc, char** argv) {
    app.add_option("BOARD", settings.board, "Its address: /dev/ttyACM0, tcp://host:6789, mqtt://broker/NAME")
        ->required();
    app.add_option("--power", settings.gains.power, "Power on a straight line, percent")
        ->capture_default_str();
    app.add_option("--kp", settings.gains.kp, "Gain of the error")->capture_default_str();
    app.add_option("--ki", settings.gains.ki, "Gain of its sum")->capture_default_str();
    app.add_option("--kd", settings.gains.kd, "Gain of its change")->capture_default_str();
    app.add_option("--cutoff", settings.gains.cutoff, "Sensor values below it are floor")
        ->capture_default_str();
    app.add_option("--period", settings.period_ms, "Milliseconds between two measurements")
        ->check(CLI::Range(1, 65535))
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    return -1;
}

}  // namespace

int main(int argc, char** argv) {
    Settings settings;
    CLI::App app{"Drives a robot along a line. Ctrl-C stops it."};
    if (const int status = read_settings(app, settings, argc, argv); status >= 0) {
        return status;
    }
    std::signal(SIGPIPE, SIG_IGN);  // a broker that goes is an error of a call
    boost::asio::io_context io;
    Board board;
    bool stopping = false;
    int status = 0;
    boost::asio::signal_set signals(io, SIGINT, SIGTERM);
    signals.async_wait([&](boost::system::error_code error, int) { stopping = stopping || !error; });
    boost::asio::co_spawn(
        io, follow(io, settings, board, stopping), [&](std::exception_ptr, const Result<void>& ended) {
            if (!ended) {
                std::fprintf(stderr, "line_follower: %s\n", to_string(ended.error()).c_str());
                status = 1;
            }
            io.stop();
        });
    io.run();
    return status;
}
