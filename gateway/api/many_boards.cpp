// SPDX-License-Identifier: Apache-2.0
#include "gateway/api/many_boards.hpp"

#include <algorithm>
#include <utility>

#include "asip/model/json.hpp"
#include "asip/program/log.hpp"
#include "gateway/api/call.hpp"
#include "gateway/gateway.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxLogged = 5;  // boards

Commands::Start start_of(const std::string& by, const std::string& client, const std::string& board) {
    Commands::Start start;
    start.by = by;
    start.client = client;
    start.target = board;
    return start;
}

}  // namespace

void BoardAnswers::answered(const std::string& board, const bus::Reply& answer) {
    boards[board] = json::parse(text_for_clients(answer), nullptr, false);
    boards[board].erase("id");
    if (--missing == 0) send();
}

void BoardAnswers::send() {
    const bool all = std::all_of(boards.begin(), boards.end(),
                                 [](const json& each) { return each.value("status", "") == "ok"; });
    const auto response = json_response({{"boards", std::move(boards)}}, all ? 200 : 207);
    for (const auto& reply : replies)
        reply.send(response);
}

void ManyBoards::add(std::optional<Run>& to, Asked asked, const http::Reply& reply) {
    if (!to) to = Run();
    to->by = std::move(asked.by);
    to->client = std::move(asked.client);
    to->stop = asked.stop;
    if (!asked.why.empty()) to->why = std::move(asked.why);
    for (const auto& board : asked.boards)
        to->boards[board] |= asked.latch;
    for (const auto& board : asked.lost)
        to->lost[board] |= asked.latch;
    auto wish = std::find_if(to->wishes.begin(), to->wishes.end(), [&](const Wish& other) {
        return other.boards == asked.boards && other.answers->boards == asked.known;
    });
    if (wish == to->wishes.end()) {
        auto answers = std::make_shared<BoardAnswers>();
        answers->boards = std::move(asked.known);
        answers->missing = asked.boards.size();
        wish = to->wishes.insert(to->wishes.end(), Wish{std::move(asked.boards), std::move(answers)});
    }
    wish->answers->replies.push_back(reply);
}

void ManyBoards::ask(Asked asked, const http::Reply& reply) {
    const bool stop = asked.stop;
    if (asked.boards.size() + asked.lost.size() <= kFew) {
        std::optional<Run> now;
        add(now, std::move(asked), reply);
        Client none;
        return start(none, std::move(*now));
    }
    auto& client = clients_[asked.client];
    if (stop)
        if (const auto given_up = std::exchange(client.resume, std::nullopt))
            for (const auto& wish : given_up->wishes)
                for (const auto& each : wish.answers->replies)
                    each.send(problem(409, "a stop came behind this: nothing was resumed"));
    const bool waits =
        busy(client, gateway_.now().time) ? !stop || client.running->stop : !stop && client.stop.has_value();
    auto& next = stop ? client.stop : client.resume;
    add(next, std::move(asked), reply);
    if (!waits) start(client, *std::exchange(next, std::nullopt));
}

void ManyBoards::start(Client& client, Run made) {
    const auto run = std::make_shared<Run>(std::move(made));
    client.running = run;
    client.begun = gateway_.now().time;
    run->open = run->boards.size();
    for (const auto& wish : run->wishes)
        if (wish.boards.empty()) wish.answers->send();
    for (const auto& [board, latch] : run->boards)
        send(*run, board, latch,
             [run, name = board](const CommandRecord& record) { answered(*run, name, *record.reply); });
    for (const auto& [board, latch] : run->lost)
        send(*run, board, latch, [](const CommandRecord&) {});
}

void ManyBoards::send(const Run& run, const std::string& board, bool latch, Commands::Done done) {
    auto start = start_of(run.by, run.client, board);
    const auto& topics = gateway_.mirror().topics();
    start.of_many = run.boards.size() + run.lost.size() > kFew;
    start.session = run.stop ? "stop" : "resume";
    start.topic = run.stop ? topics.stop(board) : topics.board_in(board);
    start.urgent = run.stop;
    json payload = json::object();
    if (!run.stop) payload["resume"] = true;
    if (run.stop && latch) payload["latch"] = true;
    if (run.stop && !run.why.empty()) payload["why"] = run.why;
    start.payload = model::dump_json(payload);
    gateway_.command(std::move(start), std::move(done));
}

void ManyBoards::answered(Run& run, const std::string& board, const bus::Reply& reply) {
    for (const auto& wish : run.wishes)
        if (std::binary_search(wish.boards.begin(), wish.boards.end(), board))
            wish.answers->answered(board, reply);
    if (reply.succeeded())
        ++run.ok;
    else if (run.others.size() < kMaxLogged)
        run.others.push_back(board + " " + (reply.reason.empty() ? "error" : reply.reason));
    if (--run.open > 0 || run.boards.size() + run.lost.size() <= kFew) return;
    std::string others;
    for (const auto& each : run.others)
        others += (others.empty() ? "" : ", ") + each;
    program::log::info(run.stop ? "stop of many boards" : "resume of many boards",
                       {{"by", run.by},
                        {"boards", run.boards.size()},
                        {"ok", run.ok},
                        {"not ok", others},
                        {"lost boards", run.lost.size()}});
}

void ManyBoards::tick(Time now) {
    for (auto each = clients_.begin(); each != clients_.end();) {
        auto& client = each->second;
        if (!busy(client, now)) {
            auto& next = client.stop ? client.stop : client.resume;
            if (!next) {
                each = clients_.erase(each);
                continue;
            }
            start(client, *std::exchange(next, std::nullopt));
        }
        ++each;
    }
}

}  // namespace asip::gateway::api
