// SPDX-License-Identifier: Apache-2.0
// Boards, a broker, a registry with its files, and a gateway with an export, in simulated time that begins
// half an hour before 2^32 ms. A person sets servos, distances change, and links of half of the boards follow
// these, some of them between two times of day. Leases are as short and as long as they may be. Each 24
// hours, or once in a shorter time, the broker restarts, with or without what it stored, half of the boards
// are without network for an hour, clocks are set back and forward, summer time ends or begins, and every
// program is replaced, the gateway by one with another export; meanwhile boards are unplugged and restart,
// and agents are killed and stopped. Nothing may be wrong in any view, and nothing may grow.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <vector>

#include "tests/support/temp_dir.hpp"
#include "tests/truth/week/programs.hpp"
#include "tests/truth/week/resources.hpp"
#include "tests/truth/week/station.hpp"

namespace truth::week {
namespace {

constexpr Duration kTick = 100ms;
constexpr Time kBegin = Time{} + std::chrono::milliseconds(std::uint64_t{1} << 32) - 30min;
constexpr const char* kAnswers = "asip/reply/ann/week";
// A lease is 60 s, a link follows within seconds, and files within ten.
constexpr Duration kSettles = 90s;
constexpr int kMinLease = 3;       // seconds
constexpr unsigned kDialects = 3;  // without Sparkplug, whose host keeps all that it heard
// A broker that hears nothing of a client for so long takes it for gone: 1.5 times its keep-alive.
constexpr Duration kUnheard = 90s;
constexpr int kFromMinute = 12 * 60, kToMinute = 20 * 60;
constexpr const char* kBetween = "12:00-20:00";
constexpr int kNear = 50, kFar = 150, kOpen = 90, kClosed = 0;

struct Plan {
    std::uint64_t seed = 1;
    unsigned boards = 20, hours = 8;
    bool traced = false;
};

class Week {
  public:
    explicit Week(Plan plan) : plan_(plan), dice_(plan.seed) {
        for (unsigned i = 0; i < plan_.boards; ++i)
            stations_.push_back(std::make_unique<Station>(
                broker_, i == 0 ? "uno1" : fmt::format("b{:03}", i),
                Station::Machine{i < 4   ? kMinLease
                                 : i < 8 ? asip::model::kMaxLeaseSeconds
                                         : asip::model::kDefaultLeaseSeconds,
                                 [this] { return unix_time(); }, [this] { return second_of_day(); },
                                 [this, i] { return broker_up_ && (network_up_ || i % 4 < 2); },
                                 asip::agent::LinkFiles(folder_.path()),
                                 [this, i](Time due) { deadlines_.set(i, due); },
                                 [this](const std::string& why) { fail(why); }}));
        view_ = presence::make_bus_view(broker_);
        start_programs();
        broker(true);
    }

    /// False: something was wrong. Prints what was done.
    bool run() {
        for (auto& station : stations_) {
            station->start(now_);
            pass(500ms);
        }
        pass(10s);
        for (std::size_t i = 1; i < stations_.size(); i += 2) {
            json link{{"name", "l"},     {"from", stations_[i - 1]->name() + "/distance/0"},
                      {"when", "above"}, {"level", 100},
                      {"back", 90},      {"to", kServo},
                      {"value", kOpen},  {"else", kClosed}};
            if (is_timed(i)) link["between"] = kBetween;
            stations_[i]->link(link, now_);
        }
        for (unsigned number = 0; number < plan_.hours * 60 && failure_.empty(); ++number)
            minute(number);
        if (failure_.empty()) fail(resources_.judge());
        const auto end = resources_.last();
        fmt::print(
            "{} boards, {} hours, seed {}: {} commands, {} comparisons, {} of known values; {:.2f} MB "
            "of memory, {} descriptors, {:.2f} MB of files: {}\n",
            plan_.boards, plan_.hours, plan_.seed, commands_, comparisons_, known_, end.memory / 1e6,
            end.descriptors, end.files / 1e6, failure_.empty() ? "nothing wrong" : failure_);
        return failure_.empty();
    }

  private:
    std::vector<presence::View*> views() const { return {registry_.get(), gateway_.get(), view_.get()}; }
    double since_begin() const { return std::chrono::duration<double>(now_ - kBegin).count(); }
    std::uint64_t unix_time() const {
        const auto wall = presence::instant(now_).wall.time_since_epoch() + clock_set_;
        return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(wall).count());
    }
    int second_of_day() const { return static_cast<int>((unix_time() + (summer_ ? 7200 : 3600)) % 86400); }
    /// Links set their targets at a time of day.
    bool is_turn_of_links() const {
        const int minute = second_of_day() / 60;
        return std::abs(minute - kFromMinute) < 3 || std::abs(minute - kToMinute) < 3;
    }
    static bool is_timed(std::size_t station) { return station % 4 == 1; }
    void note(const std::string& what) const {
        if (!plan_.traced) return;
        fmt::print("{:11.3f} {}\n", since_begin(), what);
        std::fflush(stdout);
    }
    void fail(const std::string& why) {
        if (failure_.empty() && !why.empty())
            failure_ = fmt::format("after {:.3f} s: {}", since_begin(), why);
    }
    void disturb(const std::string& what) {
        note(what);
        quiet_since_ = now_;
    }

    void pass(Duration time) {
        const Time until = now_ + time;
        while (now_ < until && failure_.empty()) {
            Time next = std::min({until, next_tick_, deadlines_.next()});
            if (const auto due = broker_.next()) next = std::min(next, *due);
            now_ = std::max(next, now_ + 1us);
            broker_.deliver_until(now_);
            for (const auto number : deadlines_.until(now_))
                stations_[number]->tick(now_);
            if (now_ < next_tick_) continue;
            next_tick_ = now_ + kTick;
            if (!unheard_.empty() && unheard_since_ + kUnheard <= now_)
                for (const auto client : std::exchange(unheard_, {}))
                    broker_.end(client, true, now_);
            for (auto* view : views())
                view->tick(now_);
        }
    }

    // --- what happens
    void minute(unsigned number) {
        // A night has all that happens in a day.
        const unsigned times = plan_.hours < 24 ? 24 / plan_.hours : 1;
        for (unsigned part = 0; part < times; ++part)
            if (const auto of_day = (number * times + part) % (24 * 60); of_day % 60 == 0) hour(of_day / 60);
        for (int i = 0; i < 6; ++i) {
            auto& measures = *stations_[dice_.below((stations_.size() + 1) / 2) * 2];
            if (measures.state() == "online") measures.measure(dice_.chance(.5) ? kNear : kFar, now_);
            set_some_servo();
            pass(5s);
        }
        if (number % 20 == 5) befall_some();
        pass(30s);
        if (number % 10 == 9) compare();
        if (number % 60 == 59) note(resources_.look());
    }
    void hour(unsigned hour) {
        if (hour == 3) broker(false), pass(20s), broker(true);
        if (hour == 6 || hour == 7) network(hour == 7);
        if (hour == 12) set_clocks(-1h, "clocks are set back");
        if (hour == 14) set_clocks(30min, "clocks are set forward");
        if (hour == 15) set_clocks({}, "clocks are right");
        if (hour == 16) summer_ = !summer_, disturb("summer time ends, or begins");
        if (hour == 18) replace_programs();
    }
    void set_clocks(Duration wrong, const std::string& what) {
        twice_until_ = now_ + (clock_set_ - wrong);
        clock_set_ = wrong;
        disturb(what);
    }
    void set_some_servo() {
        const auto& station = *stations_[dice_.below((stations_.size() + 1) / 2) * 2];
        if (!broker_up_ || station.state() != "online" || now_ - quiet_since_ < 10s) return;
        const auto id = std::to_string(++commands_);
        open_.insert(id);
        Message message;
        message.topic = "asip/" + station.name() + "/servo/in";
        message.payload = json{{"write", {0, dice_.below(181)}}, {"id", id}, {"reply_to", kAnswers}}.dump();
        broker_.publish(person_, std::move(message), now_);
    }
    /// Something happens to a board or its agent, and ends a while later.
    void befall_some() {
        static constexpr std::array kKinds{"is unplugged", "restarts", "loses its agent", "is stopped"};
        auto& station = *stations_[dice_.below(stations_.size())];
        if (station.state() != "online") return;
        const auto kind = dice_.below(kKinds.size());
        disturb(station.name() + " " + kKinds[kind]);
        if (kind == 0) station.unplug(now_);
        if (kind == 1) station.restart(now_);
        if (kind == 2) station.kill(now_);
        if (kind == 3) station.stop(now_);
        pass(dice_.chance(.5) ? kSettles : 20s);
        compare();
        if (kind == 0) station.plug(now_);
        if (kind > 1) station.start(now_);
        disturb(station.name() + " is back");
    }
    void broker(bool up) {
        disturb(up ? "broker is there" : "broker is gone");
        broker_up_ = up;
        for (auto* view : views())
            up ? view->start(now_) : view->disconnect(now_);
        if (!up) {
            for (auto& station : stations_)
                station->lose_broker(false, now_);
            for (const auto client : std::exchange(unheard_, {}))
                broker_.end(client, false, now_);
            broker_.end(person_, false, now_);
            open_.clear();
            if (dice_.chance(.5)) return;
            note("and loses what it stored");
            broker_.lose_stored();
            gateway_->lose_stored();
            return;
        }
        person_ = broker_.connect([this](const Message& message, Time) {
            const auto answer = json::parse(message.payload);
            if (open_.erase(answer.value("id", "")) == 0 || answer.value("status", "") != "ok")
                fail("an answer that was not due: " + message.payload);
        });
        broker_.subscribe(person_, kAnswers, false, false, now_);
    }
    void network(bool up) {
        disturb(up ? "network is there" : "half of the boards have no network");
        network_up_ = up;
        unheard_since_ = now_;
        for (std::size_t i = 2; !up && i < stations_.size(); ++i)
            if (i % 4 == 2)
                stations_[i]->lose_broker(true, now_);
            else if (i % 4 == 3 && stations_[i]->runs())
                unheard_.push_back(stations_[i]->lose_network(now_));
    }
    void start_programs() {
        registry_.reset();
        gateway_.reset();
        registry_ =
            std::make_unique<RegistryProgram>(broker_, dice_, folder_.path().string(), clock_set_, now_);
        gateway_ = std::make_unique<GatewayProgram>(
            broker_, static_cast<unsigned>((plan_.seed + starts_++) % kDialects), now_);
    }
    void replace_programs() {
        for (auto& station : stations_) {
            station->stop(now_);
            pass(3s);
            station->start(now_);
        }
        start_programs();
        registry_->start(now_);
        gateway_->start(now_);
        disturb("programs are replaced");
    }

    // --- what is compared
    void compare() {
        if (now_ - quiet_since_ < kSettles || is_turn_of_links()) return;
        pass(15s);  // what is to be written is on the disk
        if (!open_.empty()) fail("command " + *open_.begin() + " has no answer");
        for (std::size_t i = 0; i < stations_.size(); ++i) {
            const auto& station = *stations_[i];
            for (auto* view : views())
                compare_state(*view, station);
            if (station.state() != "online") continue;
            compare_kept(station);
            compare_servo("gateway", gateway_->servo(station.name()), station);
            const auto* source = i % 2 == 1 ? stations_[i - 1].get() : nullptr;
            if (!source || !source->distance() || source->state() != "online") continue;
            const int minute = second_of_day() / 60;
            const bool in_time = !is_timed(i) || (minute >= kFromMinute && minute < kToMinute);
            if (station.servo() != (in_time && *source->distance() == kFar ? kOpen : kClosed))
                fail("the link of " + station.name() + " does not follow");
        }
        compare_history(*stations_[dice_.below(stations_.size())]);
        if (!registry_->disk_fault().empty()) fail("registry: " + registry_->disk_fault());
    }
    void compare_state(presence::View& view, const Station& station) {
        ++comparisons_;
        const auto shown = view.board(station.name(), now_);
        if (const auto is = shown ? shown->state : "unknown"; is != station.state())
            fail(view.name() + " says " + is + " of " + station.name() + ", which is " + station.state());
    }
    void compare_servo(const std::string& view, std::optional<int> shown, const Station& station) {
        ++comparisons_;
        known_ += shown ? 1 : 0;
        if (shown != station.servo())
            fail(fmt::format("{}: the servo of {} is at {}, and it is at {}; -1 is unknown", view,
                             station.name(), shown.value_or(-1), station.servo().value_or(-1)));
    }
    /// A minute, and a time of day that came twice, may have had several angles: all of them are known.
    void compare_kept(const Station& station) {
        const auto [fine, kept] = registry_->servo(station.name(), now_);
        const auto is = station.servo();
        const bool twice = now_ < twice_until_;
        const bool within = is && kept ? kept->min <= *is && *is <= kept->max : twice && !is;
        const auto angle = kept ? std::optional(static_cast<int>(kept->mean)) : std::nullopt;
        compare_servo("registry", within && (twice || !fine) ? is : angle, station);
    }
    /// The newest change of the history is the state that there is.
    void compare_history(const Station& station) {
        ++comparisons_;
        const auto answer =
            registry_->find({{"find", "history"}, {"board", station.name()}, {"limit", 100}}, now_);
        for (const auto& item : answer.history) {
            if (item.what != "state" && item.what != "added") continue;
            if (item.state != station.state())
                fail("the history ends with " + item.state + " of " + station.name() + ", which is " +
                     station.state());
            return;
        }
    }

    const Plan plan_;
    asip::test::Dice dice_;
    asip::test::TempDir folder_;
    Time now_ = kBegin, next_tick_ = kBegin, quiet_since_ = kBegin;
    Duration clock_set_{};  // by how much the clocks of all machines are wrong
    Time twice_until_{};    // the time of day was there before
    bool summer_ = true, broker_up_ = false, network_up_ = true;
    SimBroker broker_{dice_, true};
    Deadlines deadlines_;
    std::vector<std::unique_ptr<Station>> stations_;
    std::unique_ptr<RegistryProgram> registry_;
    std::unique_ptr<GatewayProgram> gateway_;
    std::unique_ptr<presence::View> view_;
    unsigned starts_ = 0;
    SimBroker::Client person_ = 0;
    std::vector<SimBroker::Client> unheard_;  // that the broker does not know as gone yet
    Time unheard_since_{};
    std::set<std::string> open_;  // commands without an answer
    std::uint64_t commands_ = 0, comparisons_ = 0, known_ = 0;
    Resources resources_{folder_.path(), plan_.hours};
    std::string failure_;
};

}  // namespace
}  // namespace truth::week

int main(int argc, char** argv) {
    CLI::App app("A week of a bus in simulated time");
    truth::week::Plan plan;
    app.add_option("--seed", plan.seed)->capture_default_str();
    app.add_option("--boards", plan.boards)->capture_default_str();
    app.add_option("--hours", plan.hours)->capture_default_str();
    app.add_flag("--trace", plan.traced, "Print what happens");
    CLI11_PARSE(app, argc, argv);
    return truth::week::Week(plan).run() ? 0 : 1;
}
