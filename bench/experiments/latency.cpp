// SPDX-License-Identifier: Apache-2.0
// Pin 13 wired to pin 2: the time from a write of the program to the change that the board reports.
#include <algorithm>

#include "bench/experiments/experiment.hpp"
#include "bench/experiments/recorded.hpp"
#include "bench/experiments/rig.hpp"

namespace asip::experiments {
namespace {

using namespace std::chrono_literals;
using protocol::PinMode;

constexpr int kOut = 13, kIn = 2;

/// Milliseconds of each round. A round without an event throws.
std::vector<double> round_trips(const Way& way, int rounds) {
    boost::asio::io_context io;
    const auto board = finish(io, client::Board::open(io, way.address(), way.options()));
    finish(io, board.set_analog_period(0ms));
    finish(io, board.set_pin_mode(kOut, PinMode::kOutput));
    finish(io, board.digital_write(kOut, false));
    std::optional<Time> seen;
    const auto watch = board.on_digital(kIn, [&](bool) { seen = Clock::now(); });
    finish(io, board.set_pin_mode(kIn, PinMode::kInput));
    run_until(io, [] { return false; }, 100ms);
    std::vector<double> samples;
    for (int round = 0; round < rounds; ++round) {
        seen.reset();
        const auto began = Clock::now();
        finish(io, board.digital_write(kOut, round % 2 == 0));
        if (!run_until(io, [&] { return seen.has_value(); }, 2s))
            throw std::runtime_error("the board reported no change of pin 2");
        samples.push_back(std::chrono::duration<double, std::milli>(*seen - began).count());
        // Not in step with anything of the board.
        run_until(io, [] { return false; }, 4ms + std::chrono::milliseconds(round % 7));
    }
    return samples;
}

/// Share of the rounds that took at most so long.
Plot::Curve distribution(std::string name, std::vector<double> samples) {
    std::sort(samples.begin(), samples.end());
    Plot::Curve curve{std::move(name), {}, {}};
    for (std::size_t i = 0; i < samples.size(); ++i)
        curve.points.emplace_back(samples[i],
                                  100.0 * static_cast<double>(i + 1) / static_cast<double>(samples.size()));
    return curve;
}

}  // namespace

std::vector<Results> latency(const Setup& setup) {
    const int rounds = setup.quick ? 10 : 100;
    Results results{
        .name = "latency",
        .title = "From a write of pin 13 to the event of pin 2, " + std::to_string(rounds) + " rounds, ms",
        .columns = {"path", "baud", "firmware", "mean", "median", "p99", "max"},
        .rows = {},
        .notes = {"real time, a simulated Uno, program, agent and broker on one machine; the papers: a real "
                  "Uno, a broker and clients on other machines",
                  "the program is C++ (asip/client) and takes the time when the event arrives; the published "
                  "one polls each 0.1 ms, and waits 0.5 s between two rounds",
                  kWhereFrom, kNotRecorded},
        .pictures = {}};
    Plot plot{"From a write of pin 13 to the event of pin 2", "ms", "share of the rounds, %", {}};
    const test::MosquittoBroker broker;
    unsigned behind = 0;
    for (const auto& firmware : firmwares(setup.other_image)) {
        for (const bool fast : {false, true}) {
            for (const Link link : {Link::kSerial, Link::kTcp, Link::kMqtt}) {
                if (setup.quick && fast) continue;
                Simulator simulator(
                    {{"uno", firmware.image, R"([{"kind":"wire","name":"loop","from":13,"to":2}])"}});
                const Way way(broker, link, fast, simulator.port("uno"), "uno");
                if (link != Link::kSerial && fast && !way.agent_stepped_up()) continue;
                const auto samples = round_trips(way, rounds);
                behind += simulator.times_behind();
                const auto found = summary(samples);
                const std::string baud = std::to_string(fast ? kFastBaud : 57600);
                results.rows.push_back({name_of(link), baud, firmware.name, number(found.mean, 2),
                                        number(found.median, 2), number(found.p99, 2), number(found.max, 2)});
                if (firmware.name == "ours")
                    plot.curves.push_back(distribution(std::string(name_of(link)) + " " + baud, samples));
            }
        }
    }
    for (const auto& peer : kPeers)
        results.rows.push_back({"wire", "57600", std::string(peer.name) + ", recorded",
                                number(peer.round_trip_ms, 2), "", "", ""});
    note_behind(results, behind);
    results.pictures = {{"", plot.svg()}};
    return {results};
}

}  // namespace asip::experiments
