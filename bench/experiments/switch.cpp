// SPDX-License-Identifier: Apache-2.0
// Two boards that know nothing of each other: a button on one, a LED on the other, and a program between them
// (examples/two_board_switch.cpp).
#include <condition_variable>
#include <mutex>

#include "bench/experiments/experiment.hpp"
#include "bench/experiments/recorded.hpp"
#include "bench/experiments/rig.hpp"

namespace asip::experiments {
namespace {

using namespace std::chrono_literals;

/// When the LED was seen to change.
class Led {
  public:
    explicit Led(test::ChildProcess& simulator) : simulator_(simulator) {
        simulator.on_output([this](std::string_view line) {
            if (!line.starts_with("lamp ") || line.find(" led o") == std::string_view::npos) return;
            const std::lock_guard lock(mutex_);
            changed_ = Clock::now();
            arrived_.notify_one();
        });
    }
    ~Led() { simulator_.on_output({}); }

    void forget() {
        const std::lock_guard lock(mutex_);
        changed_.reset();
    }
    Time wait() {
        std::unique_lock lock(mutex_);
        if (!arrived_.wait_for(lock, 5s, [this] { return changed_.has_value(); }))
            throw std::runtime_error("the LED did not follow the button");
        return *changed_;
    }

  private:
    test::ChildProcess& simulator_;
    std::mutex mutex_;
    std::condition_variable arrived_;
    std::optional<Time> changed_;
};

std::vector<double> press(Simulator& simulator, int presses) {
    Led led(simulator.process());
    std::vector<double> samples;
    for (int i = 0; i < 2 * presses; ++i) {
        led.forget();
        const auto began = Clock::now();
        simulator.command(i % 2 == 0 ? "press desk/button" : "release desk/button");
        samples.push_back(std::chrono::duration<double, std::milli>(led.wait() - began).count());
        std::this_thread::sleep_for(5ms + std::chrono::milliseconds(i % 7));
    }
    return samples;
}

}  // namespace

std::vector<Results> two_board_switch(const Setup& setup) {
    const int presses = setup.quick ? 3 : 50;
    Results results{
        .name = "switch",
        .title = "A button on one board switches a LED on another: from the button to the LED, " +
                 std::to_string(2 * presses) + " times, ms",
        .columns = {"path", "firmware", "median", "p99", "max"},
        .rows = {},
        .notes = {"examples/two_board_switch.cpp; serial lines at 57600 baud, as the example opens them; "
                  "agents step "
                  "theirs up; up to 0.4 ms are the simulator's own",
                  "the papers: two real boards, a real button, programs in Java, Python, Racket and Erlang",
                  kNotRecorded},
        .pictures = {}};
    Bars bars{"From the button to the LED, median, ms", {}};
    const test::MosquittoBroker broker;
    unsigned behind = 0;
    for (const auto& firmware : firmwares(setup.other_image)) {
        for (const Link link : {Link::kSerial, Link::kTcp, Link::kMqtt}) {
            if (setup.quick && link != Link::kMqtt) continue;
            Simulator simulator({{"desk", firmware.image, R"([{"kind":"button","name":"button","pin":2}])"},
                                 {"lamp", firmware.image, R"([{"kind":"led","name":"led","pin":13}])"}});
            const Way desk(broker, link, true, simulator.port("desk"), "desk");
            const Way lamp(broker, link, true, simulator.port("lamp"), "lamp");
            test::ChildProcess program(
                {ASIP_PROGRAMS "/example-two_board_switch", desk.address(), lamp.address()});
            if (!program.wait_for_output("switches pin")) throw std::runtime_error(program.errors());
            std::this_thread::sleep_for(200ms);
            const auto samples = press(simulator, presses);
            behind += simulator.times_behind();
            const auto found = summary(samples);
            results.rows.push_back({name_of(link), firmware.name, number(found.median, 2),
                                    number(found.p99, 2), number(found.max, 2)});
            bars.bars.emplace_back(firmware.name + std::string(", ") + name_of(link), found.median);
        }
    }
    note_behind(results, behind);
    results.pictures = {{"", bars.svg()}};
    return {results};
}

}  // namespace asip::experiments
