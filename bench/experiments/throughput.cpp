// SPDX-License-Identifier: Apache-2.0
// A square wave on an input pin, made faster until the program has not seen, or not copied to another pin,
// each of its edges.
#include <atomic>
#include <cmath>

#include "bench/experiments/experiment.hpp"
#include "bench/experiments/recorded.hpp"
#include "bench/experiments/rig.hpp"

#include <boost/asio/detached.hpp>

namespace asip::experiments {
namespace {

using namespace std::chrono_literals;
using protocol::PinMode;

constexpr int kWave = 3, kCopy = 13;
constexpr double kMostHertz = 5'000;
constexpr const char* kParts =
    R"([{"kind":"square-wave","name":"wave","pin":3,"hertz":0},{"kind":"led","name":"copy","pin":13}])";

/// A program that watches one pin and may copy it to another, as the published one does.
class Copier {
  public:
    Copier(Simulator& simulator, const Way& way)
        : simulator_(simulator), board_(finish(io_, client::Board::open(io_, way.address(), way.options()))) {
        finish(io_, board_.set_analog_period(0ms));
        finish(io_, board_.set_pin_mode(kCopy, PinMode::kOutput));
        finish(io_, board_.digital_write(kCopy, false));
        finish(io_, board_.set_pin_mode(kWave, PinMode::kInput));
        watch_ = board_.on_digital(kWave, [this](bool level) {
            ++edges_seen_;
            if (copying_) copy(level);
        });
        simulator_.process().on_output([this](std::string_view line) {
            if (line.find(" copy ") != std::string_view::npos) ++edges_copied_;
            if (line.ends_with(" wave 0")) wave_ended_ = true;
        });
        settle();
    }
    ~Copier() { simulator_.process().on_output({}); }

    /// Whether each edge of a burst arrived, and was copied where `copying`.
    bool follows(double hertz, bool copying) {
        const int pulses = std::max(20, static_cast<int>(hertz * 0.3));
        copying_ = copying;
        edges_seen_ = edges_copied_ = 0;
        wave_ended_ = false;
        simulator_.command("burst wave " + number(hertz, 1) + " " + std::to_string(pulses));
        if (!run_until(io_, [&] { return wave_ended_.load(); }, 30s))
            throw std::runtime_error("the square wave did not end");
        settle();
        return edges_seen_ == 2 * pulses && (!copying || edges_copied_ == 2 * pulses);
    }

  private:
    void copy(bool level) {
        boost::asio::co_spawn(io_, board_.digital_write(kCopy, level),
                              [](std::exception_ptr, const client::Result<void>&) {});
    }
    /// Until nothing has changed for a while.
    void settle() {
        for (int before = -1; before != edges_seen_ + edges_copied_;) {
            before = edges_seen_ + edges_copied_;
            run_until(io_, [] { return false; }, 60ms);
        }
    }

    boost::asio::io_context io_;
    Simulator& simulator_;
    client::Board board_;
    client::Subscription watch_;
    bool copying_ = false;
    std::atomic<int> edges_seen_ = 0, edges_copied_ = 0;
    std::atomic<bool> wave_ended_ = false;
};

/// The fastest wave that is followed, to 2 %; 0 where not even the slowest is. A computer that is busy for a
/// moment shall not decide: what fails is tried again.
double fastest(Copier& copier, bool copying, bool quick) {
    const auto follows = [&](double hertz) {
        return copier.follows(hertz, copying) || copier.follows(hertz, copying);
    };
    double good = 0, bad = quick ? 100 : 50;
    while (bad <= (quick ? 100 : kMostHertz) && follows(bad)) {
        good = bad;
        bad *= 2;
    }
    while (!quick && good > 0 && bad / good > 1.02) {
        const double middle = std::sqrt(good * bad);
        (follows(middle) ? good : bad) = middle;
    }
    return good;
}

}  // namespace

std::vector<Results> throughput(const Setup& setup) {
    Results results{
        .name = "throughput",
        .title = "The fastest square wave of which no edge is lost, Hz",
        .columns = {"path", "baud", "firmware", "reported", "copied to pin 13"},
        .rows = {},
        .notes = {"reported: the program gets an event of each edge. Copied: it writes each to another pin, "
                  "as the published program does; each write is acknowledged, which theirs is not",
                  "a burst of 0.3 s for each frequency, found by halving to 2 %; the papers: a signal "
                  "generator, a real Uno, and counters at both pins",
                  kWhereFrom, kNotRecorded},
        .pictures = {}};
    Bars bars{"Fastest square wave, Hz: every edge reported", {}};
    const test::MosquittoBroker broker;
    unsigned behind = 0;
    for (const auto& firmware : firmwares(setup.other_image)) {
        for (const bool fast : {false, true}) {
            for (const Link link : {Link::kSerial, Link::kTcp, Link::kMqtt}) {
                if (setup.quick && (fast || link == Link::kTcp)) continue;
                Simulator simulator({{"uno", firmware.image, kParts}});
                const Way way(broker, link, fast, simulator.port("uno"), "uno");
                if (link != Link::kSerial && fast && !way.agent_stepped_up()) continue;
                Copier copier(simulator, way);
                const double reported = fastest(copier, false, setup.quick);
                const double copied = fastest(copier, true, setup.quick);
                behind += simulator.times_behind();
                const std::string baud = std::to_string(fast ? kFastBaud : 57600);
                results.rows.push_back(
                    {name_of(link), baud, firmware.name, number(reported, 0), number(copied, 0)});
                bars.bars.emplace_back(firmware.name + ", " + name_of(link) + " " + baud, reported);
            }
        }
    }
    for (const auto& peer : kPeers) {
        results.rows.push_back(
            {"wire", "57600", std::string(peer.name) + ", recorded", number(peer.square_wave_hertz, 0), ""});
        bars.bars.emplace_back(std::string(peer.name) + ", wire 57600", peer.square_wave_hertz);
    }
    note_behind(results, behind);
    results.pictures = {{"", bars.svg()}};
    return {results};
}

}  // namespace asip::experiments
