// SPDX-License-Identifier: Apache-2.0
// Four boards on one broker, a program beside each that wants to know all others: how long until all see each
// other, until a board that comes later is seen, and until it is known that one has gone.
#include <algorithm>
#include <csignal>

#include "asip/catalogue/bus_view.hpp"
#include "asip/mqtt/client.hpp"
#include "bench/experiments/experiment.hpp"
#include "bench/experiments/recorded.hpp"
#include "bench/experiments/rig.hpp"

namespace asip::experiments {
namespace {

using namespace std::chrono_literals;

const std::vector<std::string> kBoards{"B1", "B2", "B3", "B4"};

/// What one program sees of the bus, from the bus alone: no registry.
class View {
  public:
    View(boost::asio::io_context& io, const test::MosquittoBroker& broker)
        : client_(io, options(broker), handlers()) {
        client_.subscribe(topics_.root() + "/servicebus/#", {.qos = 1, .no_local = false, .retained = true});
        client_.start();
    }

    bool is(const std::string& board, const std::string& state) const {
        const auto item = view_.board(board, catalogue::instant_now());
        return item && item->state == state;
    }
    bool sees_all() const {
        return std::all_of(kBoards.begin(), kBoards.end(),
                           [this](const std::string& board) { return is(board, "online"); });
    }
    bool ready() const { return client_.subscribed(); }

  private:
    static mqtt::Options options(const test::MosquittoBroker& broker) {
        mqtt::Options options;
        options.brokers = {{"127.0.0.1", broker.port(), false}};
        return options;
    }
    mqtt::Client::Handlers handlers() {
        mqtt::Client::Handlers handlers;
        handlers.on_message = [this](const mqtt::Message& message) { view_.apply(message, Clock::now()); };
        return handlers;
    }

    bus::Topics topics_;
    mutable catalogue::BusView view_{bus::Topics()};
    mqtt::Client client_;
};

/// Milliseconds of what is found in one run.
struct Found {
    double all_at_once = 0, late_program = 0, late_board = 0, gone = 0;
};

/// Four boards that run, a broker, a view beside each board; no agent yet.
class Scene {
  public:
    Scene() : simulator_(boards()) {
        for (std::size_t i = 0; i < kBoards.size(); ++i)
            open_view();
        until("a connection to the broker", [&] {
            return std::all_of(views_.begin(), views_.end(), [](const auto& view) { return view->ready(); });
        });
    }

    double all_at_once() {
        return timed("all boards to see each other", [&] {
            for (const auto& board : kBoards)
                start(board);
            return [&] { return everybody_sees_all(); };
        });
    }
    double late_board() {
        for (std::size_t i = 0; i + 1 < kBoards.size(); ++i)
            start(kBoards[i]);
        until("the first three boards", [&] { return everybody_sees("B3", "online"); });
        return timed("all to see a board that came late", [&] {
            start(kBoards.back());
            return [&] { return everybody_sees_all(); };
        });
    }
    double late_program() {
        return timed("a late program to see all boards", [&] {
            open_view();
            return [&] { return views_.back()->sees_all(); };
        });
    }
    unsigned times_behind() const { return simulator_.times_behind(); }
    double gone() {
        return timed("all to know that a board has gone", [&] {
            agents_.back()->signal(SIGKILL);
            return [&] { return everybody_sees(kBoards.back(), "lost"); };
        });
    }

  private:
    static std::vector<Simulator::Board> boards() {
        std::vector<Simulator::Board> all;
        for (const auto& name : kBoards)
            all.push_back({name, ASIP_IMAGES "/asip_uno_services.elf", "[]"});
        return all;
    }
    void open_view() { views_.push_back(std::make_unique<View>(io_, broker_)); }
    void start(const std::string& board) {
        agents_.push_back(std::make_unique<test::ChildProcess>(
            std::vector<std::string>{ASIP_PROGRAMS "/asip-agent", "--serial", simulator_.port(board),
                                     "--name", board, "--broker", broker_.url()}));
    }
    bool everybody_sees_all() const {
        return std::all_of(views_.begin(), views_.end(), [](const auto& view) { return view->sees_all(); });
    }
    bool everybody_sees(const std::string& board, const std::string& state) const {
        return std::all_of(views_.begin(), views_.end(),
                           [&](const auto& view) { return view->is(board, state); });
    }
    void until(const char* what, const std::function<bool()>& condition) {
        if (!run_until(io_, condition, 30s))
            throw std::runtime_error(std::string("waited 30 s in vain for ") + what);
    }
    template <class Begin>
    double timed(const char* what, Begin begin) {
        const auto began = Clock::now();
        until(what, begin());
        return std::chrono::duration<double, std::milli>(Clock::now() - began).count();
    }

    test::MosquittoBroker broker_;
    Simulator simulator_;
    boost::asio::io_context io_;
    std::vector<std::unique_ptr<View>> views_;
    std::vector<std::unique_ptr<test::ChildProcess>> agents_;
};

}  // namespace

std::vector<Results> discovery(const Setup& setup) {
    const int runs = setup.quick ? 1 : 5;
    std::vector<Found> found;
    unsigned behind = 0;
    for (int i = 0; i < runs; ++i) {
        Found one;
        {
            Scene scene;
            one.all_at_once = scene.all_at_once();
            one.late_program = scene.late_program();
            behind += scene.times_behind();
        }
        Scene scene;
        one.late_board = scene.late_board();
        one.gone = scene.gone();
        behind += scene.times_behind();
        found.push_back(one);
    }
    Results results{
        .name = "discovery",
        .title = "Four boards on one broker, no registry, " + std::to_string(runs) + " runs, ms",
        .columns = {"until", "median", "max"},
        .rows = {},
        .notes = {"boards already run, their agents are started; an agent first looks for the board, steps "
                  "the line up, and asks for 1.3 s whether another agent holds the name",
                  "the papers: boards publish their names themselves and have no retained description, so "
                  "a board that comes late sees the others when those announce again",
                  kNotRecorded},
        .pictures = {}};
    Bars bars{"Discovery, median, ms", {}};
    const auto add = [&](const char* name, double Found::* value) {
        std::vector<double> samples;
        for (const auto& one : found)
            samples.push_back(one.*value);
        const auto of_all = summary(samples);
        results.rows.push_back({name, number(of_all.median, 0), number(of_all.max, 0)});
        bars.bars.emplace_back(name, of_all.median);
    };
    add("all four, started at once, see each other", &Found::all_at_once);
    add("all see a board that joins three others late", &Found::late_board);
    add("a program that starts late sees all four", &Found::late_program);
    add("all know that the agent of a board was killed", &Found::gone);
    note_behind(results, behind);
    results.pictures = {{"", bars.svg()}};
    return {results};
}

}  // namespace asip::experiments
