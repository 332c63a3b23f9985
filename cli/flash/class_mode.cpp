// SPDX-License-Identifier: Apache-2.0
// Boards from the box, one after the other or all at once: each that speaks no ASIP is loaded and named.
#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>

#include "asip/bus/request/agent_requests.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/model/port_name.hpp"
#include "asip/program/options.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/flash/load.hpp"
#include "cli/flash/no_asip.hpp"
#include "cli/text/terminal_buffer.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

constexpr Duration kNameTime = 10s;    // until the board has stored it
constexpr Duration kComingTime = 40s;  // until it is online by it
constexpr auto kLoadTime = 6min;
constexpr std::chrono::seconds kReopen{1};

class ClassRoom {
  public:
    ClassRoom(const ClassOptions& options, Environment& environment)
        : options_(options),
          environment_(environment),
          session_(environment),
          records_(options.output, RecordPrinter::Count::kStream, environment.out) {}

    int run() {
        const auto descriptions =
            session_.subscribe(environment_.topics.description("+"),
                               [this](const mqtt::Message& message) { described(message); });
        if (const auto connected = session_.connect(); !connected)
            return environment_.fail_with(connected.error());
        session_.wait_retained();
        if (seats_.empty() && options_.output.for_people())
            environment_.note(
                "waiting for boards: plug them in. One that is plugged in already is seen within a minute. "
                "Ctrl-C ends it");
        while (!session_.stopped() && (options_.count == 0 || good_ < options_.count)) {
            session_.run_until([this] { return changed_; }, Clock::now() + 500ms);
            changed_ = false;
            for (auto& [port, seat] : seats_)
                go_on(port, *seat);
            show_progress();
        }
        clear_line();
        for (auto& [port, seat] : seats_)
            if (!is_over(*seat) && seat->step != Step::kWaiting)
                row(port, port, "left", *seat,
                    std::string("interrupted; its agent goes on") +
                        (options_.names ? "; start this again to name it" : ""));
        return sum_up();
    }

  private:
    enum class Step { kWaiting, kLoading, kNaming, kComing, kDone, kFailed };
    /// One board, by the name that its port has.
    struct Seat {
        std::string session;
        std::string link;
        std::string name;  // that it is to have
        std::string sketch, chip;
        std::string progress;
        bool force = false;
        bool only_name = false;  // it speaks ASIP already
        bool loaded = false;
        Step step = Step::kWaiting;
        Time began{}, until{};
        std::unique_ptr<Load> load;
        BusSession::Call naming;
        std::optional<bus::Reply> named;
    };

    void described(const mqtt::Message& message) {
        const auto topic = environment_.topics.parse(message.topic);
        if (!topic || !model::valid_board_name(topic->board)) return;
        const std::string board(topic->board);
        changed_ = true;
        const auto found = seats_.find(board);
        if (message.payload.empty()) {
            online_.erase(board);
            if (found != seats_.end() && is_over(*found->second)) seats_.erase(found);
            return;
        }
        used_.insert(board);
        const auto description = model::parse_description(message.payload);
        if (!description) return;
        const auto state = description->state ? description->state->state : model::BoardState::kLost;
        if (state == model::BoardState::kOnline)
            online_[board] = *description;
        else
            online_.erase(board);
        if (found != seats_.end()) {
            auto& seat = *found->second;
            if (!is_over(seat)) {
                seat.progress = Load::progress(message.payload);
                return;
            }
            // The same agent: it is the board that was seen already, unless a user unplugged it.
            const bool away =
                description->state && description->state->reason == model::StateReason::kUnplugged;
            if (away) seats_.erase(found);
            if (away || seat.session == description->session) return;
            seats_.erase(found);
        }
        consider(board, *description);
    }

    static bool is_over(const Seat& seat) { return seat.step == Step::kDone || seat.step == Step::kFailed; }

    void consider(const std::string& board, const model::Description& description) {
        if (options_.host != "*" && description.agent.host != options_.host) return;
        if (description.link.kind != "serial") return;
        const bool nothing = speaks_no_asip(description);
        const bool online = online_.contains(board);
        if ((!nothing && !online) || expected_.contains(board)) return;
        auto seat = std::make_unique<Seat>();
        seat->session = description.session;
        seat->link = description.link.path;
        seat->sketch = description.firmware.sketch;
        seat->chip = description.firmware.chip;
        // A sketch of ASIP 0.4 without extensions could not keep a name, for one.
        const bool old = online && description.firmware.extensions.empty();
        seat->force = old || (online && options_.load.force);
        if (online && !seat->force && lacks_name(board, description)) {
            seat->only_name = true;  // once all names of the bus are known
        } else if (online && !seat->force) {
            seat->step = Step::kDone;
            row(board, board, "passed over", *seat, "it runs " + seat->sketch + " already");
            ++good_;
        }
        seats_[board] = std::move(seat);
    }

    /// Loaded, and called by its port: a class that was ended early, or that gave no names, left it so.
    bool lacks_name(const std::string& board, const model::Description& description) const {
        return options_.names && description.firmware.extensions.has(protocol::kIdentity) &&
               board == model::name_of_port(description.link.path, description.agent.host);
    }

    void go_on(const std::string& port, Seat& seat) {
        const auto now = Clock::now();
        switch (seat.step) {
            case Step::kWaiting: {
                seat.began = now;
                if (seat.only_name) {
                    seat.name = next_name();
                    return give_name(port, seat);
                }
                auto load = options_.load;
                load.force = seat.force;
                seat.until = now + kLoadTime;
                seat.step = Step::kLoading;
                seat.load = std::make_unique<Load>(environment_, session_, port, load);
                return;
            }
            case Step::kLoading:
                if (seat.load->reply()) return loaded(port, seat, bus::Reply(*seat.load->reply()));
                break;
            case Step::kNaming:
                if (seat.named) return named(port, seat);
                break;
            case Step::kComing:
                if (online_.contains(seat.name)) return done(port, seat);
                break;
            default:
                return;
        }
        if (now < seat.until) return;
        failed(port, seat,
               seat.step == Step::kLoading  ? "its agent does not answer"
               : seat.step == Step::kNaming ? "it does not take its name"
                                            : "it is named, but does not come as " + seat.name);
    }

    void loaded(const std::string& port, Seat& seat, const bus::Reply& reply) {
        seat.load.reset();
        if (!reply.succeeded()) return failed(port, seat, for_terminal(why_not(reply)));
        const auto answer = model::parse_json(reply.answer).value_or(nlohmann::json::object());
        seat.loaded = true;
        seat.sketch = value_at(answer, "after.sketch");
        seat.chip = value_at(answer, "after.chip");
        const auto stored = value_at(answer, "after.name");
        seat.name = !stored.empty() ? stored : options_.names ? next_name() : port;
        if (stored.empty() && options_.names) return give_name(port, seat);
        used_.insert(seat.name);
        expected_.insert(seat.name);
        wait_for(seat);
    }

    void give_name(const std::string& port, Seat& seat) {
        used_.insert(seat.name);
        expected_.insert(seat.name);
        seat.step = Step::kNaming;
        seat.until = Clock::now() + kNameTime;
        seat.naming =
            session_.command({.topic = environment_.topics.board_in(port), .payload = "#,I," + seat.name},
                             [&seat](const bus::Reply& said) { seat.named = said; });
    }

    // Its agent asks a board for its name when it opens the port.
    void named(const std::string& port, Seat& seat) {
        if (!seat.named->succeeded())
            return failed(port, seat, "it keeps no name: " + bus::sentence_of(*seat.named));
        session_.publish(environment_.topics.board_in(port),
                         bus::encode({bus::PortRequest::What::kRelease, kReopen}, "class"), 1);
        wait_for(seat);
    }

    void wait_for(Seat& seat) {
        seat.step = Step::kComing;
        seat.until = Clock::now() + kComingTime;
    }

    void done(const std::string& port, Seat& seat) {
        seat.step = Step::kDone;
        ++good_;
        row(port, seat.name, seat.loaded ? "loaded" : "named", seat, seat.sketch + " on " + seat.chip);
    }

    void failed(const std::string& port, Seat& seat, const std::string& why) {
        seat.step = Step::kFailed;
        seat.load.reset();
        row(port, port, "failed", seat, why);
    }

    std::string next_name() {
        std::string name;
        do {
            name = *options_.names;
            name.replace(name.find("{}"), 2, std::to_string(++number_));
        } while (used_.contains(name));
        return name;
    }

    void row(const std::string& port, const std::string& board, const std::string& result, const Seat& seat,
             const std::string& text) {
        const auto seconds =
            seat.began == Time{} ? 0.0 : std::chrono::duration<double>(Clock::now() - seat.began).count();
        const bool has_failed = result == "failed";
        if (!has_failed) results_["failed"].erase(port);
        results_[result].insert(has_failed ? port : board);
        if (!options_.output.for_people()) {
            nlohmann::json record{{"board", board},    {"port", seat.link},
                                  {"result", result},  {"sketch", seat.sketch},
                                  {"chip", seat.chip}, {"seconds", std::round(seconds * 10) / 10}};
            if (has_failed) record["error"] = text;
            return records_.print(record);
        }
        clear_line();
        environment_.out << fmt::format("{:<20} {:<12} {}", for_terminal(board), result, for_terminal(text));
        if (result == "loaded" || result == "named")
            environment_.out << fmt::format(", {}, {:.0f} s", port_text(seat.link), seconds);
        if (has_failed)
            environment_.out << fmt::format(" ({}). Plug it in again to try again", port_text(seat.link));
        environment_.out << std::endl;
    }

    // One line that is drawn again, where it is a terminal.
    void show_progress() {
        if (!environment_.terminal() || !options_.output.for_people()) return;
        std::string line;
        for (const auto& [port, seat] : seats_)
            if (!is_over(*seat))
                line += (line.empty() ? "" : "  ") + port + ": " +
                        (seat->step == Step::kLoading  ? seat->progress
                         : seat->step == Step::kNaming ? "naming"
                                                       : "starting");
        if (line == drawn_) return;
        clear_line();
        drawn_ = line;
        environment_.out << line.substr(0, environment_.width - 1) << std::flush;
    }

    void clear_line() {
        if (drawn_.empty()) return;
        environment_.out << own_control('\r')
                         << std::string(std::min(drawn_.size(), environment_.width - 1), ' ')
                         << own_control('\r') << std::flush;
        drawn_.clear();
    }

    int sum_up() {
        const auto& failed = results_["failed"];
        if (options_.output.for_people()) {
            environment_.out << fmt::format("{} loaded, ", results_["loaded"].size());
            for (const auto* less_usual : {"named", "left"})
                if (const auto count = results_[less_usual].size(); count > 0)
                    environment_.out << fmt::format("{} {}, ", count, less_usual);
            environment_.out << fmt::format("{} passed over, {} failed\n", results_["passed over"].size(),
                                            failed.size())
                             << std::flush;
        }
        return failed.empty() ? program::kExitOk : program::kExitFailure;
    }

    const ClassOptions& options_;
    Environment& environment_;
    BusSession session_;
    RecordPrinter records_;
    std::map<std::string, std::unique_ptr<Seat>> seats_;
    std::map<std::string, model::Description> online_;
    std::set<std::string> used_;      // names of the bus
    std::set<std::string> expected_;  // names that boards of this class have now
    std::map<std::string, std::set<std::string>> results_;
    std::string drawn_;
    std::size_t number_ = 0;
    std::size_t good_ = 0;
    bool changed_ = false;
};

}  // namespace

int run_class(const ClassOptions& options, Environment& environment) {
    if (options.names) {
        auto example = *options.names;
        const auto place = example.find("{}");
        if (place == std::string::npos)
            return environment.fail_with(
                {program::kExitUsage, "--names: \"" + example + "\" needs {} for the number: student-{}"});
        example.replace(place, 2, "999");
        if (!model::valid_board_name(example) || example.size() > model::kMaxStoredNameBytes)
            return environment.fail_with(
                {program::kExitUsage,
                 "--names: " + (model::valid_board_name(example) ? "a board keeps 32 bytes at most"
                                                                 : model::explain_board_name(example))});
    }
    return ClassRoom(options, environment).run();
}

}  // namespace asip::cli
