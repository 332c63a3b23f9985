// SPDX-License-Identifier: Apache-2.0
// Boards whose sketch is out of date: their agents load the newer one, some at a time.
#include <fmt/format.h>

#include <algorithm>
#include <list>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/bus/request/agent_requests.hpp"
#include "asip/model/json.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/flash/load.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

constexpr std::size_t kAtOnce = 4;
constexpr std::size_t kMaxFailures = 3;
constexpr Duration kLastWords = std::chrono::seconds(10);  // of an agent whose board is lost

class Update {
  public:
    Update(const UpdateOptions& options, Environment& environment, BusSession& session)
        : options_(options),
          environment_(environment),
          session_(session),
          records_(options.output, RecordPrinter::Count::kStream, environment.out),
          states_(session.subscribe(environment.topics.state("+"),
                                    [this](const mqtt::Message& message) { came(message); })) {}

    void add(const bus::BoardItem& board) {
        if (board.state == "online" && !board.available.empty())
            waiting_.push_back({board.board, board.sketch, board.version});
    }

    int run() {
        if (waiting_.empty()) {
            environment_.note("no board is out of date");
            return program::kExitOk;
        }
        while (!session_.stopped() && (begin_some() || !under_way_.empty())) {
            const auto any = [this] {
                return std::any_of(under_way_.begin(), under_way_.end(),
                                   [](const Board& each) { return each.load->reply().has_value(); });
            };
            session_.run_until(any, Clock::now() + std::chrono::seconds(1));
            for (auto each = under_way_.begin(); each != under_way_.end();) {
                const auto& reply = each->load->reply();
                const bool gone = !reply && Clock::now() >= each->gone;
                if (reply) ended(*each, *reply);
                if (gone)
                    ended(*each, bus::Reply::refused(std::string(bus::kRefusedNotLoaded),
                                                     "its agent ended; start it, and load it again"));
                each = reply || gone ? under_way_.erase(each) : std::next(each);
            }
        }
        return sum_up();
    }

  private:
    struct Board {
        std::string name, sketch, was;
        std::unique_ptr<Load> load{};
        Time began{}, gone = Time::max();
    };

    /// The state of a board: an agent that ends leaves no answer, and its broker says that the board is lost.
    void came(const mqtt::Message& message) {
        const auto topic = environment_.topics.parse(message.topic);
        for (auto& board : under_way_)
            if (topic && board.name == topic->board)
                board.gone = message.payload == "lost" || message.payload == "offline"
                                 ? Clock::now() + kLastWords
                                 : Time::max();
    }

    /// False: no other is begun.
    bool begin_some() {
        if (failed_ >= kMaxFailures) return false;
        while (under_way_.size() < kAtOnce && !waiting_.empty()) {
            under_way_.splice(under_way_.end(), waiting_, waiting_.begin());
            auto& board = under_way_.back();
            board.began = Clock::now();
            board.load = std::make_unique<Load>(environment_, session_, board.name,
                                                LoadOptions{.firmware = {}, .board = {}, .update = true});
        }
        return !under_way_.empty();
    }

    void ended(const Board& board, const bus::Reply& reply) {
        // Another user has the port. It is not the board's fault, and whether it is up to date shows later.
        const bool passed_over = reply.reason == bus::kRefusedReleased;
        const bool good = reply.succeeded();
        ++(good ? updated_ : passed_over ? passed_over_ : failed_);
        const std::string result = good ? "updated" : passed_over ? "passed over" : "failed";
        const auto why = good ? std::string() : for_terminal(why_not(reply));
        const auto answer = model::parse_json(reply.answer).value_or(nlohmann::json::object());
        const auto version = value_at(answer, "after.version");
        if (!options_.output.for_people()) {
            nlohmann::json record{
                {"board", board.name}, {"result", result}, {"sketch", board.sketch}, {"was", board.was}};
            if (good) record["version"] = version;
            if (!good) record["error"] = why;
            return records_.print(record);
        }
        const auto seconds = std::chrono::duration<double>(Clock::now() - board.began).count();
        environment_.out << fmt::format("{:<20} {:<12} ", for_terminal(board.name), result)
                         << (good ? fmt::format("{} {}, {:.0f} s", for_terminal(board.sketch),
                                                for_terminal(version), seconds)
                                  : why)
                         << std::endl;
    }

    int sum_up() {
        const auto left = waiting_.size() + under_way_.size() + passed_over_;
        environment_.note(fmt::format("{} updated, {} failed, {} left{}", updated_, failed_, left,
                                      left == 0 ? "" : "; the same again goes on with them"));
        return failed_ + left == 0 ? program::kExitOk : program::kExitFailure;
    }

    const UpdateOptions& options_;
    Environment& environment_;
    BusSession& session_;
    RecordPrinter records_;
    std::list<Board> waiting_, under_way_;
    BusSession::Subscription states_;
    std::size_t updated_ = 0, failed_ = 0, passed_over_ = 0;
};

}  // namespace

int run_update(const UpdateOptions& options, Environment& environment) {
    BusSession session(environment);
    BoardSource source(environment, session);
    Update update(options, environment, session);
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    const auto boards = choose_boards(source, options.target, options.labels);
    if (!boards) return environment.fail_with(boards.error());
    for (const auto& board : *boards)
        update.add(board.item);
    return update.run();
}

}  // namespace asip::cli
