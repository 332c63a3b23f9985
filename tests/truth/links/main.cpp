// SPDX-License-Identifier: Apache-2.0
// Random histories of one link in simulated time: a contact bounces, messages repeat, boards reset, persons
// set the target, agents and the broker are killed, frozen and started again in all orders. At the end the
// target stands as docs/links.md says, and no more commands were sent than there were causes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <deque>
#include <optional>
#include <vector>

#include "asip/links/rules.hpp"
#include "asip/links/sources.hpp"
#include "tests/support/dice.hpp"
#include "tests/unit/links/contact.hpp"

namespace {

using namespace asip;
using namespace std::chrono_literals;
using links::contact;
using links::When;
using nlohmann::json;

constexpr Duration kStep = 5ms;
constexpr Duration kWild = 20s;
constexpr Duration kQuiet = 8s;

class World {
  public:
    World(std::uint64_t seed, bool traced) : dice_(seed), traced_(traced) {
        static constexpr When kWhen[] = {When::kFollows, When::kInverted, When::kToggles};
        link_.name = "l";
        link_.board = "desk";
        link_.source = "io/2";
        link_.target = "io/13";
        link_.when = dice_.one_of(kWhen);
        button_ = dice_.chance(.7);
    }

    std::string run() {
        start_source();
        start_target();
        broker_up_ = true;
        connect_all();
        for (const Time end = now_ + kWild; now_ < end && failure_.empty(); step())
            wild();
        mend();
        for (const Time end = now_ + kQuiet; now_ < end && failure_.empty(); step()) {
        }
        if (failure_.empty()) judge();
        return failure_;
    }

  private:
    struct Process {
        bool alive = false, frozen = false, connected = false;
        bool runs() const { return alive && !frozen; }
    };
    struct OnItsWay {
        Time at;
        mqtt::Message message;
    };

    void say(const std::string& text) {
        if (traced_)
            fmt::print("{:8.3f} {}\n", std::chrono::duration<double>(now_.time_since_epoch()).count(), text);
    }

    // --- the broker
    void publish(const std::string& topic, const std::string& payload) {
        if (!broker_up_) return;
        mqtt::Message message;
        message.topic = topic;
        message.payload = payload;
        retained_[topic] = message;
        deliver(message);
    }
    void deliver(const mqtt::Message& message) {
        if (!target_.connected) return;
        const int copies = dice_.chance(.1) ? 2 : 1;  // QoS 1
        for (int i = 0; i < copies; ++i) {
            last_delivery_ = std::max(last_delivery_, now_ + dice_.between(1, 30) * 1ms);
            on_its_way_.push_back({last_delivery_, message});
        }
    }
    void connect_all() {
        if (!broker_up_) return;
        if (source_.runs() && !std::exchange(source_.connected, true)) announce();
        if (target_.runs() && !std::exchange(target_.connected, true)) {
            sources_->connected(now_);
            for (auto [topic, message] : retained_) {
                message.retain = true;
                deliver(message);
            }
        }
    }
    void cut(Process& process, bool will) {
        if (!std::exchange(process.connected, false)) return;
        if (&process == &source_ && will) publish(topics_.state("desk"), "lost");
        if (&process == &target_) {
            on_its_way_.clear();
            if (process.runs()) hear(sources_->disconnected());
        }
    }

    // --- the source's agent
    void start_source() {
        source_ = {.alive = true};
        session_ = "s" + std::to_string(1000 + ++sessions_);
        seq_ = 0;
        values_ = {};
        values_.use({contact(button_ ? "button" : "motion")}, now_);
        report();
    }
    void announce() {
        publish(topics_.state("desk"), "online");
        publish(topics_.properties("desk"),
                property::to_text(property::PropertyList{{"desk", session_, ++seq_}, values_.properties()}));
        show();
    }
    void show() {
        if (!source_.connected) return;
        auto document = property::values_of(values_, now_);
        document.head = {"desk", session_, ++seq_};
        document.clock = "c-1";
        publish(topics_.values("desk"), property::to_text(document));
        shown_at_ = now_;
        show_ = false;
    }
    void report() {
        if (source_.runs() &&
            values_.reported("io", {{"digital", {{"2", level_ ? 1 : 0}}}}, property::How::kReported, now_))
            show_ = true;
    }

    // --- the target's agent
    void start_target() {
        target_ = {.alive = true};
        known_.reset();
        sources_.emplace(topics_, "lamp", "links", [this] { return dice_.draw(); });
        rules_.emplace(links::Rules::World{[this](const std::string&) { return known_; },
                                           [this] { return board_there_; }, [] { return 0; },
                                           [](const links::Link&) { return false; }});
        rules_->set(link_, kept_, now_);
        hear(sources_->want({{"desk", "io/2"}}, now_));
        ++causes_;
    }
    void hear(const links::Sources::Tolds& tolds) {
        for (const auto& told : tolds) {
            if (told.kind == links::Told::Kind::kAct) {
                say("told " + std::string(to_text(told.act)));
                if (told.act == property::ButtonAct::kPress) ++told_presses_;
                rules_->act(told.board, told.id, told.act, now_);
            } else if (told.kind == links::Told::Kind::kValue) {
                say("told " + (told.value ? told.value->dump() : "?"));
                if (told.value && *told.value != told_) {
                    told_ = *told.value;
                    person_ = false;
                    ++causes_;
                }
                rules_->source(told.board, told.id, told.value, now_);
            } else {
                rules_->present(told.board, told.is, now_);
            }
        }
    }
    void run_target() {
        if (!target_.runs()) return;
        while (!on_its_way_.empty() && on_its_way_.front().at <= now_) {
            const auto message = on_its_way_.front().message;
            on_its_way_.pop_front();
            hear(sources_->take(message, now_));
        }
        hear(sources_->tick(now_));
        while (!flying_.empty() && now_ >= flying_.front().first) {
            const auto value = flying_.front().second;
            flying_.pop_front();
            if (board_there_) set_lamp(value), known_ = value, rules_->executed("io/13", "l");
            rules_->finished("l", board_there_, "gone");
        }
        for (const auto& order : rules_->run(now_)) {
            ++commands_;
            say("command " + order.value.dump() + ", because " + order.because);
            if (!flying_.empty() && link_.when != When::kToggles) failure_ = "two commands at once";
            if (!board_there_) failure_ = "a command to a board that is away";
            flying_.emplace_back(now_ + dice_.between(1, 40) * 1ms, order.value);
        }
        kept_ = rules_->links().at("l").kept;
    }
    void set_lamp(const json& value) { lamp_ = value.get<bool>(); }

    // --- what happens
    void step() {
        now_ += kStep;
        if (bounces_ > 0) {
            level_ = --bounces_ % 2 == 0 ? settles_ : !settles_;
            report();
        }
        if (source_.runs()) {
            if (source_.connected && now_ >= renewed_ + 1s)
                publish(topics_.state("desk"), "online"), renewed_ = now_;
            show_ = values_.tick(now_) || show_;
            if (show_ && (!shown_at_ || now_ - *shown_at_ >= 100ms)) show();
        }
        run_target();
    }
    void move(bool on) {
        if (settles_ == on) return;
        settles_ = on;
        presses_ += on ? 1 : 0;
        pressed_at_ = now_;
        say(on ? "pressed" : "released");
        if (!button_) {
            level_ = on;
            return report();
        }
        bounces_ = 1;
    }
    void wild() {
        if (dice_.chance(.01)) move(!settles_);
        if (dice_.chance(.002) && target_.runs() && board_there_ && flying_.empty()) {
            const bool value = dice_.chance(.5);
            say(value ? "a person sets on" : "a person sets off");
            set_lamp(value);
            known_ = value;
            person_ = true;
            rules_->executed("io/13", "");
            kept_ = rules_->links().at("l").kept;
        }
        if (dice_.chance(.002)) fail_or_mend_source();
        if (dice_.chance(.002)) fail_or_mend_target();
        if (dice_.chance(.002)) broker_up_ ? broker_down() : broker_back();
        if (dice_.chance(.001)) board_there_ ? board_gone() : board_back();
        if (dice_.chance(.02)) connect_all();
    }
    void fail_or_mend_source() {
        if (!source_.alive) return say("source starts"), start_source();
        if (source_.frozen) return say("source goes on"), void(source_.frozen = false), report();
        if (dice_.chance(.5)) return say("source freezes"), void(source_.frozen = true);
        say("source killed");
        cut(source_, true);
        source_ = {};
    }
    void fail_or_mend_target() {
        if (!target_.alive) return say("target starts"), start_target();
        if (target_.frozen) return say("target goes on"), void(target_.frozen = false);
        if (dice_.chance(.5)) return say("target freezes"), void(target_.frozen = true);
        say("target killed");
        cut(target_, false);
        target_ = {};
        // What it had sent is executed, or not.
        if (!flying_.empty() && dice_.chance(.5)) set_lamp(flying_.back().second);
        flying_.clear();
    }
    void broker_down() {
        say("broker down");
        broker_up_ = false;
        source_.connected = false;
        if (target_.connected) cut(target_, false);
        if (dice_.chance(.5)) retained_.clear();
    }
    void broker_back() {
        say("broker back");
        broker_up_ = true;
        if (retained_.contains(topics_.state("desk"))) publish(topics_.state("desk"), "lost");
    }
    void board_gone() {
        say("board of the target away");
        board_there_ = false;
    }
    void board_back() {
        say("board of the target back, reset");
        board_there_ = true;
        lamp_ = false;
        known_.reset();
        if (rules_ && target_.alive) rules_->target_back();
        reset_ = true;
        ++causes_;
    }
    void mend() {
        say("quiet");
        if (!source_.alive) start_source();
        if (!target_.alive) start_target();
        source_.frozen = target_.frozen = false;
        report();
        if (!broker_up_) broker_back();
        if (!board_there_) board_back();
        connect_all();
    }
    void judge() {
        const bool event = link_.when == When::kToggles;
        if (event) {
            if (commands_ > told_presses_ || told_presses_ > presses_)
                failure_ =
                    fmt::format("{} presses, {} told, {} commands", presses_, told_presses_, commands_);
            return;
        }
        if (told_ != json(settles_)) failure_ = "the source is not known as it is";
        if (commands_ > causes_) failure_ = fmt::format("{} commands for {} causes", commands_, causes_);
        const bool wanted = link_.when == When::kFollows ? settles_ : !settles_;
        if (!person_ && lamp_ != wanted)
            failure_ =
                fmt::format("the target is {}, the source {}", lamp_ ? "on" : "off", settles_ ? "on" : "off");
    }

    test::Dice dice_;
    const bool traced_;
    bus::Topics topics_;
    Time now_{};
    links::Link link_;
    bool button_ = true;
    std::string failure_;
    // broker
    bool broker_up_ = false;
    std::map<std::string, mqtt::Message> retained_;
    std::deque<OnItsWay> on_its_way_;
    Time last_delivery_{};
    // source
    Process source_;
    std::string session_;
    std::uint64_t seq_ = 0, sessions_ = 0;
    property::KnownValues values_;
    std::optional<Time> shown_at_;
    Time renewed_{};
    bool show_ = false, level_ = false, settles_ = false;
    int bounces_ = 0;
    Time pressed_at_{};
    // target
    Process target_;
    std::optional<links::Sources> sources_;
    std::optional<links::Rules> rules_;
    links::Kept kept_;
    std::optional<json> known_;
    std::deque<std::pair<Time, json>> flying_;
    bool board_there_ = true, lamp_ = false, reset_ = false;
    // what should be
    json told_;
    bool person_ = false;
    std::uint64_t presses_ = 0, told_presses_ = 0, commands_ = 0, causes_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Random histories of a link");
    std::uint64_t first = 1, histories = 2000;
    std::vector<std::uint64_t> seeds;
    app.add_option("--first", first);
    app.add_option("--histories", histories);
    app.add_option("--seed", seeds);
    CLI11_PARSE(app, argc, argv);
    int wrong = 0;
    for (const auto seed : seeds)
        if (const auto failure = World(seed, true).run(); !failure.empty())
            fmt::print("{}\n", failure), ++wrong;
    for (auto seed = first; seeds.empty() && seed < first + histories && wrong < 5; ++seed)
        if (const auto failure = World(seed, false).run(); !failure.empty())
            fmt::print("seed {}: {}\n", seed, failure), ++wrong;
    fmt::print("{} histories, {} wrong\n", seeds.empty() ? histories : seeds.size(), wrong);
    return wrong == 0 ? 0 : 1;
}
