// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/values/history.hpp"

#include <random>

#include "tests/truth/values/world.hpp"

namespace truth::values {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr unsigned kSteps = 24;

class History final : World {
  public:
    History(std::uint64_t seed, bool traced) : World(seed, traced), random_(seed) {
        command("io", {{"mode", {3, 3}}});
    }

    End run() {
        for (unsigned step = 0; step < kSteps && end_.failure.empty(); ++step) {
            one_step();
            if (below(3) == 0) look();
        }
        look();
        return std::move(end_);
    }

    End run_lamp(unsigned reads) {
        command("io", {{"write", {3, 1}}});
        for (unsigned i = 0; i < reads && end_.failure.empty(); ++i) {
            const auto before = bench_.board.executed.size();
            read();
            if (bench_.board.executed.size() != before) fail("a read made the agent send something");
            if (i % 50 == 0) set_servo();
            if (i % 97 == 0) late_joiner();
            if (truth_[kLamp].value != json(true)) fail("the lamp is dark");
            pass(5ms);
        }
        look();
        return std::move(end_);
    }

  private:
    unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

    void one_step() {
        switch (below(15)) {
            case 0:
            case 1:
            case 2:
                return set_servo();
            case 3:
            case 4:
                return set_lamp();
            case 5:
            case 6:
                return report();
            case 7:
                return read_many();
            case 8:
                return restart_board();
            case 9:
                return unplug();
            case 10:
                return in_doubt();
            case 11:
                return restart_broker();
            case 12:
                note("another gateway and registry");
                return late_joiner();
            case 13:
                return clash();
            default:
                return pass(std::chrono::milliseconds(below(3000)));
        }
    }

    void send(const std::string& service, const json& request, const std::string& line,
              const std::string& id) {
        switch (below(3)) {
            case 0:
                note("raw " + line);
                bench_.hear("asip/uno1/in", line);
                break;
            case 1:
                note("client " + line);
                bench_.client_says(line);
                break;
            default:
                if (command(service, request)) truth_[id].proven = true;
                return;
        }
        carry();
        truth_[id].proven = false;
    }

    /// Each differs from those around it.
    int next_angle() { return static_cast<int>((truth_[kServo].all.size() * 7 + 1) % 181); }

    void set_servo() {
        const int angle = next_angle();
        send("servo", {{"write", {0, angle}}}, "S,W,0," + std::to_string(angle), kServo);
    }

    void set_lamp() {
        const int level = static_cast<int>(below(2));
        send("io", {{"write", {3, level}}}, "I,d,3," + std::to_string(level), kLamp);
    }

    void report() {
        const int distance = static_cast<int>(below(401));
        note("distance " + std::to_string(distance));
        bench_.say(bench_.board.framed("@D,e,1,{" + std::to_string(distance) + "}"));
        set(kDistance, distance == 0 ? json() : json(distance));
        truth_[kDistance].proven = true;
        carry();
    }

    void read_many() {
        const auto before = bench_.board.executed.size();
        for (unsigned i = below(20); i > 0; --i) {
            read();
            if (below(4) == 0) pass(std::chrono::milliseconds(below(200)));
        }
        if (bench_.board.executed.size() != before) fail("a read made the agent send something");
    }

    void restart_board() {
        note("board restarts");
        begin_anew();
        bench_.say(bench_.board.reboot());
        wait_for_board();
    }

    void unplug() {
        note("unplugged");
        bench_.unplug();
        pass(std::chrono::milliseconds(below(2000)));
        begin_anew();
        bench_.board.reboot();
        bench_.plug();
        wait_for_board();
    }

    /// The line to the board loses what is sent: a command may or may not be executed.
    void in_doubt() {
        note("the line loses some");
        bench_.board.lose_lines = static_cast<int>(1 + below(3));
        command("servo", {{"write", {0, next_angle()}}, {"deadline_ms", 500}});
        pass(3s);
        bench_.board.lose_lines = 0;
        for (auto& [id, truth] : truth_)
            truth.proven = false;
        wait_for_board();
    }

    void restart_broker() {
        note("broker restarts, empty");
        broker_is_lost();
        if (below(2) == 0) set_servo();
        pass(std::chrono::milliseconds(below(3000)));
        bench_.connect();
        carry();
        late_joiner();
    }

    /// A command makes the lamp's pin an input, and people say that it is a plug: nobody sets it then.
    void clash() {
        label({{kLamp, {{"class", "plug"}}}});
        if (!command("io", {{"mode", {3, 2}}})) return;
        if (below(2) == 0) late_joiner();
        judge_clash(true);
        if (!command("io", {{"mode", {3, 3}}})) return;
        judge_clash(false);
        label({{kLamp, nullptr}});
    }

    std::mt19937_64 random_;
};

}  // namespace

End run_history(std::uint64_t seed, bool traced) {
    return History(seed, traced).run();
}

End run_lamp(std::uint64_t seed, unsigned reads) {
    return History(seed, false).run_lamp(reads);
}

}  // namespace truth::values
