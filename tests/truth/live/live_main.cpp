// The truth test with everything real: firmware in simavr behind a damaged line, agents, Mosquitto, clients
// over MQTT and TCP. What the LEDs at the boards' pins showed is compared with each answer.
//
// That it can fail was tried with agents that were broken on purpose; what it then said, within three or four
// rounds:
//   answers ok at once                    ok and not executed, a bad command was ok
//   loses each 50th answer                never answered
//   sends each 20th command twice         sent to the board twice
// Not noticed within three rounds: commands refused without a board and sent when it is back, a
// point-to-point client that does not learn what was damaged (unit_agent has tests for both).
#include <fmt/format.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/support/bus_probe.hpp"
#include "tests/support/mosquitto_broker.hpp"
#include "tests/truth/live/live_board.hpp"
#include "tests/truth/live/tcp_client.hpp"

namespace {

namespace test = asip::test;
using truth::now_ms;
using namespace std::chrono_literals;

constexpr std::int64_t kDeadlineMs = 5000;
// The longest pause of broker or agent, and what the programs need besides.
constexpr std::int64_t kSlackMs = 2000;
// A test that itself was not run for so long cannot judge the times of others.
constexpr std::int64_t kStarvedMs = 300;
// What was damaged may have been held by a stalled line, or by a fence that was waited for.
constexpr std::int64_t kDamageLastsMs = 3000;
constexpr auto kBackOnline = 60s;
constexpr std::uint64_t kMaxNotBegun = 3;
constexpr const char* kReplies = "asip/reply/truth";

struct Counts {
    std::uint64_t rounds = 0, commands = 0, faults = 0, incidents = 0, ok = 0, error = 0, doubt = 0,
                  timeout = 0, refused = 0, repeated = 0, nobody_there = 0, starved = 0, invisible = 0,
                  failures = 0, not_begun = 0;
};

/// One command: a PWM duty that this pin has never had before.
struct Sent {
    truth::LiveBoard* board;
    int pin = 0;
    int duty = 0;  ///< 0: a request that the board or the agent must not execute
    bool tcp = false;
    std::string request{};
    std::int64_t at = 0;
    std::int64_t answered = 0;
    int copies = 1;  ///< how often the same message was sent
    int answers = 0;
    std::string status{};
    std::string answer{};
};

/// A board's agent, or the broker, is not there: what is under way then nobody answers.
struct Outage {
    const truth::LiveBoard* board;
    std::int64_t from;
    std::size_t announced;  ///< how often the agent had been announced when it began
    std::int64_t until = std::numeric_limits<std::int64_t>::max();
    bool over() const { return until != std::numeric_limits<std::int64_t>::max(); }
};

class Round {
  public:
    Round(std::uint64_t seed, Counts& counts);
    void run(std::int64_t active_ms);

  private:
    void connect();
    void set_up();
    bool online(const truth::LiveBoard& board) const;
    void pump();
    void command_over_bus();
    void command_over_tcp();
    void take_replies();
    void answered(Sent& sent, std::string status, std::string answer);
    void incident();
    void drain();
    void check();
    void check(const Sent& sent);
    bool nobody_there(const Sent& sent) const;
    bool starved(std::int64_t from, std::int64_t until) const;
    bool executed(const Sent& sent) const;
    void fail(const Sent& sent, const std::string& what);
    std::size_t announced(const truth::LiveBoard& board) const;
    void begin_outage(const truth::LiveBoard& board) {
        outages_.push_back({&board, now_ms(), announced(board)});
    }
    void end_outages();

    std::uint64_t seed_;
    Counts& counts_;
    truth::Dice dice_;
    test::MosquittoBroker broker_;
    std::vector<std::unique_ptr<truth::LiveBoard>> boards_;
    std::vector<std::unique_ptr<truth::TcpClient>> clients_;  // two of each board
    std::unique_ptr<test::BusProbe> probe_;
    std::size_t replies_seen_ = 0;
    bool broker_restarted_ = false;
    std::deque<Sent> sent_;
    std::array<std::array<int, 16>, 2> duties_{};
    std::vector<Outage> outages_;
    std::vector<std::pair<std::int64_t, std::int64_t>> starved_;
    std::int64_t pumped_ = 0;
    std::vector<std::pair<std::int64_t, std::function<void()>>> later_;
};

Round::Round(std::uint64_t seed, Counts& counts) : seed_(seed), counts_(counts), dice_(seed) {
    ++counts_.rounds;
    boards_.push_back(
        std::make_unique<truth::LiveBoard>("ours", "asip_uno", true, broker_.url(), dice_.draw()));
    boards_.push_back(
        std::make_unique<truth::LiveBoard>("plain", "asip_uno_04", false, broker_.url(), dice_.draw()));
    set_up();
}

void Round::connect() {
    replies_seen_ = 0;
    for (Outage& outage : outages_)
        outage.announced = 0;
    probe_ = std::make_unique<test::BusProbe>(broker_.port(),
                                              std::vector<std::string>{kReplies, "asip/servicebus/+/$state"});
}

bool Round::online(const truth::LiveBoard& board) const {
    return probe_->last("asip/servicebus/" + board.name() + "/$state") == "online";
}

void Round::set_up() {
    connect();
    for (auto& board : boards_) {
        if (!test::wait_until([&] { return online(*board); }, 60s))
            throw std::runtime_error(board->name() + " is not online: " + board->agent().errors());
        for (const int pin : truth::kPins)
            if (!probe_->request("asip/" + board->name() + "/in", fmt::format("I,P,{},5", pin)))
                throw std::runtime_error("no answer on a good line");
        for (int i = 0; i < 2; ++i)
            clients_.push_back(std::make_unique<truth::TcpClient>(board->client_port()));
    }
}

std::size_t Round::announced(const truth::LiveBoard& board) const {
    if (!probe_) return 0;
    const auto states = probe_->messages("asip/servicebus/" + board.name() + "/$state");
    return static_cast<std::size_t>(std::count_if(
        states.begin(), states.end(), [](const auto& state) { return state.payload == "online"; }));
}

// How long an agent takes to start depends on the machine.
void Round::end_outages() {
    for (Outage& outage : outages_) {
        if (outage.over()) continue;
        if (online(*outage.board) && announced(*outage.board) > outage.announced)
            outage.until = now_ms();
        else if (now_ms() > outage.from + std::chrono::milliseconds(kBackOnline).count())
            throw std::runtime_error(
                fmt::format("seed {}: {} does not come back", seed_, outage.board->name()));
    }
}

void Round::pump() {
    if (pumped_ != 0 && now_ms() > pumped_ + kStarvedMs) starved_.emplace_back(pumped_, now_ms());
    pumped_ = now_ms();
    for (auto& client : clients_)
        client->pump();
    for (auto& board : boards_)
        board->observe();
    take_replies();
    for (std::size_t i = 0; i < later_.size();)
        if (later_[i].first <= now_ms()) {
            const auto action = later_[i].second;
            later_.erase(later_.begin() + static_cast<std::ptrdiff_t>(i));
            action();
        } else {
            ++i;
        }
    if (probe_) end_outages();
    test::wait_until([] { return false; }, 3ms);
}

void Round::command_over_bus() {
    const auto index = dice_.below(boards_.size());
    Sent sent{.board = boards_[index].get(), .at = now_ms()};
    // Nobody answers what an agent cannot hear.
    if (!probe_ || (broker_restarted_ && !online(*sent.board))) return;
    std::string line;
    switch (dice_.below(6)) {
        case 0:
            line = "I,a,99,1";
            break;
        case 1:
            line = "I,d,2,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21";
            break;
        default:
            sent.pin = truth::kPins[dice_.below(3)];
            sent.duty = duties_[index][static_cast<std::size_t>(sent.pin)] + 1;
            if (sent.duty > 254) return;
            duties_[index][static_cast<std::size_t>(sent.pin)] = sent.duty;
            line = fmt::format("I,a,{},{}", sent.pin, sent.duty);
    }
    asip::mqtt::Message message{.topic = "asip/" + sent.board->name() + "/in", .payload = line, .qos = 1};
    message.response_topic = kReplies;
    message.correlation = std::to_string(sent_.size());
    sent.request = line;
    sent_.push_back(std::move(sent));
    ++counts_.commands;
    probe_->publish(message);
    if (!dice_.chance(0.1)) return;
    ++counts_.repeated;
    ++sent_.back().copies;
    probe_->publish(message);
}

void Round::command_over_tcp() {
    const auto number = dice_.below(clients_.size());
    const auto index = number / 2;
    Sent sent{.board = boards_[index].get(), .tcp = true, .at = now_ms()};
    sent.pin = number % 2 == 0 ? truth::kPins[3] : truth::kPins[4 + dice_.below(2)];
    int& duty = duties_[index][static_cast<std::size_t>(sent.pin)];
    if (duty >= 254) return;
    sent.duty = ++duty;
    sent.request = fmt::format("I,a,{},{}", sent.pin, sent.duty);
    sent_.push_back(sent);
    ++counts_.commands;
    Sent& kept = sent_.back();
    const bool accepted =
        clients_[number]->submit(kept.request, 5s, [this, &kept](const asip::session::Finished& end) {
            using asip::session::Ending;
            const auto ending = end.ending;
            const bool ok = ending == Ending::kExecuted;
            answered(kept,
                     ok                              ? "ok"
                     : ending == Ending::kBoardError ? "error"
                     : ending == Ending::kNotSent    ? "refused"
                                                     : "timeout",
                     asip::session::to_string(ending));
        });
    if (!accepted) answered(kept, "refused", "not submitted");
}

void Round::take_replies() {
    if (!probe_) return;
    const auto replies = probe_->messages(kReplies);
    for (; replies_seen_ < replies.size(); ++replies_seen_) {
        const auto& reply = replies[replies_seen_];
        const auto number = std::strtoul(reply.correlation.c_str(), nullptr, 10);
        if (number >= sent_.size() || sent_[number].tcp) continue;
        for (const char* status : {"ok", "error", "timeout", "refused"})
            if (reply.payload.find(fmt::format(R"("status":"{}")", status)) != std::string::npos)
                answered(sent_[number], status, reply.payload);
    }
}

void Round::answered(Sent& sent, std::string status, std::string answer) {
    ++sent.answers;
    sent.answered = now_ms();
    sent.status = std::move(status);
    sent.answer = std::move(answer);
}

void Round::incident() {
    auto& board = *boards_[dice_.below(boards_.size())];
    const auto lasts = dice_.between(50, 1200);
    ++counts_.incidents;
    switch (dice_.below(12)) {
        case 0:
        case 1:
        case 9:
        case 10:
        case 11:
            board.line().damage(dice_.chance(0.5) ? 1.0 / 200 : 1.0 / 40);
            later_.emplace_back(now_ms() + lasts, [&board] { board.line().damage(0); });
            return;
        case 2:
            board.line().stall(true);
            later_.emplace_back(now_ms() + lasts, [&board] { board.line().stall(false); });
            return;
        case 3:
            return board.reset();
        case 4:
            board.line().unplug();
            board.reset();
            later_.emplace_back(now_ms() + lasts, [&board] { board.line().plug(); });
            return;
        case 5:
            begin_outage(board);
            board.agent().signal(SIGKILL);
            later_.emplace_back(now_ms() + lasts, [&board] { board.start_agent(); });
            return;
        case 6:
            board.agent().signal(SIGSTOP);
            later_.emplace_back(now_ms() + lasts, [&board] { board.agent().signal(SIGCONT); });
            return;
        case 7:
            broker_.freeze();
            later_.emplace_back(now_ms() + lasts, [this] { broker_.thaw(); });
            return;
        default:
            for (const auto& each : boards_)
                begin_outage(*each);
            probe_.reset();
            broker_.kill();
            broker_restarted_ = true;
            later_.emplace_back(now_ms() + lasts, [this] {
                broker_.start();
                connect();
            });
    }
}

void Round::run(std::int64_t active_ms) {
    const auto until = now_ms() + active_ms;
    auto next_command = now_ms();
    auto next_incident = now_ms() + 500;
    while (now_ms() < until) {
        pump();
        if (now_ms() >= next_command) {
            dice_.chance(0.5) ? command_over_bus() : command_over_tcp();
            next_command = now_ms() + dice_.between(1, 40);
        }
        if (now_ms() >= next_incident && later_.empty()) {
            incident();
            next_incident = now_ms() + dice_.between(100, 2500);
        }
    }
    drain();
    check();
}

void Round::drain() {
    const auto until = now_ms() + kDeadlineMs + kSlackMs;
    const auto waiting = [&] {
        return std::any_of(sent_.begin(), sent_.end(), [](const Sent& sent) { return sent.answers == 0; });
    };
    while (!later_.empty() || (now_ms() < until && waiting()))
        pump();
    for (const auto end = now_ms() + 300; now_ms() < end;)
        pump();
}

bool Round::nobody_there(const Sent& sent) const {
    return std::any_of(outages_.begin(), outages_.end(), [&](const Outage& outage) {
        return outage.board == sent.board && outage.from <= sent.at + kDeadlineMs && outage.until >= sent.at;
    });
}

bool Round::starved(std::int64_t from, std::int64_t until) const {
    return std::any_of(starved_.begin(), starved_.end(),
                       [&](const auto& span) { return span.first <= until && span.second >= from; });
}

bool Round::executed(const Sent& sent) const {
    return sent.board->executed_at(sent.pin, sent.duty) != 0;
}

void Round::fail(const Sent& sent, const std::string& what) {
    ++counts_.failures;
    fmt::print("FAILED (seed {}): {} pin {} duty {} over {}: {}; answer {}\n", seed_, sent.board->name(),
               sent.pin, sent.duty, sent.tcp ? "TCP" : "MQTT", what, sent.answer);
}

void Round::check() {
    // What the simulators report may come later than the answers.
    test::wait_until([&] {
        for (const auto& board : boards_)
            board->observe();
        return std::all_of(sent_.begin(), sent_.end(),
                           [&](const Sent& sent) { return sent.status != "ok" || executed(sent); });
    });
    for (const auto& board : boards_)
        counts_.faults += board->line().faults();
    for (const Sent& sent : sent_)
        check(sent);
}

void Round::check(const Sent& sent) {
    const auto latest = sent.at + kDeadlineMs + kSlackMs;
    const auto to_board = sent.board->line().seen(sent.request);
    if (sent.answers > sent.copies) fail(sent, "answered twice");
    if (sent.duty != 0 && to_board.times > 1) fail(sent, "sent to the board twice");
    if (sent.duty != 0 && to_board.last_ms > latest && !starved(sent.at, to_board.last_ms))
        fail(sent, "sent to the board after its deadline");
    if (sent.answers == 0) {
        if (!nobody_there(sent)) return fail(sent, "never answered");
        ++counts_.nobody_there;
        return;
    }
    if (sent.answered > latest) {
        if (!starved(sent.at, sent.answered)) fail(sent, "answered late");
        ++counts_.starved;
    }
    if (sent.status == "refused") ++counts_.refused;
    if (sent.status == "error") ++counts_.error;
    if (sent.status == "timeout")
        ++(sent.answer.find("doubt") != std::string::npos ? counts_.doubt : counts_.timeout);
    if (sent.status == "refused" && sent.duty != 0 && to_board.times != 0)
        fail(sent, "refused and sent to the board");
    if (sent.status != "ok") return;
    ++counts_.ok;
    if (sent.duty == 0) return fail(sent, "a bad command was ok");
    if (executed(sent)) return;
    const bool excused = !sent.board->has_checksums() &&
                         sent.board->line().damaged(sent.at - kDamageLastsMs, sent.answered + kStarvedMs);
    if (!excused) return fail(sent, "ok and not executed");
    ++counts_.invisible;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Checks that every answer of agents is true, with real firmware, broker and processes.");
    std::uint64_t first = 1;
    int rounds = 1;
    double seconds = 0;
    double active = 8;
    app.add_option("--first", first, "Seed of the first round")->capture_default_str();
    app.add_option("--rounds", rounds, "How many rounds")->capture_default_str();
    app.add_option("--seconds", seconds, "Instead: rounds until then");
    app.add_option("--active", active, "Seconds of commands in a round")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    Counts counts;
    const auto end = now_ms() + static_cast<std::int64_t>(seconds * 1000);
    for (std::uint64_t seed = first;
         seconds > 0 ? now_ms() < end : seed < first + static_cast<unsigned>(rounds); ++seed) {
        std::unique_ptr<Round> round;
        try {
            round = std::make_unique<Round>(seed, counts);
        } catch (const std::runtime_error& error) {
            // Another program may have taken a port that was free.
            fmt::print("seed {}: not begun: {}\n", seed, error.what());
            if (++counts.not_begun > kMaxNotBegun) return 1;
            continue;
        }
        round->run(static_cast<std::int64_t>(active * 1000));
        fmt::print(
            "seed {}: {} commands, {} incidents, {} faults of the line; ok {}, error {}, doubt {}, timeout "
            "{}, refused {}, repeated {}, unanswered while agent or broker was gone {}, late on a starved "
            "machine {}; false ok without a checksum that left no sign {}; wrong answers {}\n",
            seed, counts.commands, counts.incidents, counts.faults, counts.ok, counts.error, counts.doubt,
            counts.timeout, counts.refused, counts.repeated, counts.nobody_there, counts.starved,
            counts.invisible, counts.failures);
        std::fflush(stdout);
    }
    return counts.failures == 0 && counts.commands > 0 ? 0 : 1;
}
