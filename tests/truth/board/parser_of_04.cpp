// SPDX-License-Identifier: Apache-2.0
#include <deque>
#include <utility>

#include "tests/literal/model_04.hpp"
#include "tests/truth/board/firmware.hpp"

namespace truth {

namespace {

class ParserOf04 : public Firmware {
  public:
    std::string power_up(Micros now) override {
        state_ = {};
        state_.last = now;
        return firmware_.power_up(now);
    }

    // A pass reads up to a line end, and executes one request.
    void run(Micros now, std::string& received, std::size_t room, bool idle, Pass& pass) override {
        const auto end = received.find('\n');
        const std::string read = received.substr(0, end == std::string::npos ? end : end + 1);
        received.erase(0, read.size());
        const Micros silent = now - state_.last;
        if (read.empty()) {
            state_.parser.pass(silent / 1000);
            state_.last += silent / 1000 * 1000;
        } else {
            state_.parser.receive(read);
            state_.last = now;
        }
        for (auto& request : state_.parser.take_executed())
            state_.requests.push_back(std::move(request));
        execute(now, room, idle, pass);
        pass.read = read;
    }

    unsigned baud() const override { return firmware_.baud(); }

  private:
    struct State {
        asip::test::Model04 parser;
        std::deque<std::string> requests;  // not executed yet
        std::string line, left;            // what is being executed, and what of it is still to be read
        Micros last = 0;                   // until then its silence is counted
    };

    // A board that is about to send reads on later.
    void execute(Micros now, std::size_t room, bool idle, Pass& pass) {
        if (state_.left.empty() && !state_.requests.empty()) {
            state_.line = state_.left = std::move(state_.requests.front()) + '\n';
            state_.requests.pop_front();
        }
        const bool executes = !state_.left.empty();
        firmware_.run(now, state_.left, room, idle, pass);
        pass.text = executes && state_.left.empty() ? state_.line : std::string();
    }

    Firmware& firmware_ = firmware_of_04();
    State state_;
};

}  // namespace

Firmware& firmware_with_parser_of_04() {
    static ParserOf04 firmware;
    return firmware;
}

}  // namespace truth
