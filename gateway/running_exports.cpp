// SPDX-License-Identifier: Apache-2.0
#include "gateway/running_exports.hpp"

#include <iterator>
#include <utility>

#include "asip/bus/request/reply.hpp"
#include "asip/program/log.hpp"

namespace asip::gateway {
namespace {

using bus::TopicKind;

}  // namespace

Exports::Exports(boost::asio::io_context& io, const exports::MakeExport& make, mqtt::Options mqtt,
                 Gateway& gateway)
    : gateway_(gateway), connection_(io, std::move(mqtt)), export_(make(system_random(), port())) {
    told_ = gateway.mirror().standing().listen([this](const std::string& board,
                                                      const Standing::Change& change) {
        // An empty list of ids is all of them.
        if (change.anew || !change.ids.empty())
            export_->known(board, change.anew ? std::vector<std::string>() : change.ids, gateway_.now().time);
        for (const auto& [id, act] : change.acts)
            export_->acted(board, id, act);
    });
}

exports::Export::Port Exports::port() {
    auto port = connection_.port([this]() -> exports::Export& { return *export_; });
    port.ready = [this] { return gateway_.mirror().ready(); };
    port.boards = [this] { return gateway_.mirror().board_names(); };
    port.board = [this](const std::string& name) { return board(name); };
    port.value = [this](const std::string& board, const exports::Property& property) {
        auto shown = gateway_.mirror().shown(board, property, gateway_.now());
        return shown ? std::optional(std::move(shown->value)) : std::nullopt;
    };
    port.refused = [this](std::uint64_t values) { gateway_.count_refused_values(values); };
    port.want = [this](const std::string& board, const std::string& service, double hz) {
        return gateway_.caller().want(board, service, hz);
    };
    port.command = [this](const std::string& board, const property::Request& request,
                          std::function<void(std::string)> done) {
        command(board, request, std::move(done));
    };
    port.log = [](const std::string& sentence) { program::log::info(sentence); };
    port.wall_ms = [this] {
        return std::chrono::duration_cast<std::chrono::milliseconds>(gateway_.now().wall.time_since_epoch())
            .count();
    };
    return port;
}

std::optional<exports::Export::Present> Exports::board(const std::string& name) {
    auto found = gateway_.things().find(gateway_.mirror(), name, gateway_.now());
    if (!found) return std::nullopt;
    return exports::Export::Present{model::takes_commands(found->state), std::move(found->board),
                                    found->state, std::move(found->session)};
}

void Exports::command(const std::string& board, const property::Request& request,
                      std::function<void(std::string)> done) {
    const std::string by(export_->by());
    if (!gateway_.command_rates().take(by, gateway_.now().time))
        return done("too many commands; try again in a moment");
    Commands::Start start;
    start.session = by;
    start.by = by;
    start.client = by;
    start.target = board + "/" + request.service;
    start.topic = gateway_.mirror().topics().service_in(board, request.service);
    start.payload = request.payload;
    gateway_.command(std::move(start), [done = std::move(done)](const CommandRecord& record) {
        done(record.reply->succeeded() ? std::string() : bus::why_of(*record.reply));
    });
}

void Exports::subscribed() {
    export_->subscribed(gateway_.now().time);
}

void Exports::changes() {
    const auto& log = gateway_.mirror().log();
    const auto now = gateway_.now().time;
    std::set<std::string> boards;
    bool lost = false;
    while (seen_ < log.last()) {
        const auto* change = log.change(++seen_);
        if (change == nullptr)
            lost = true;
        else if (!change->board.empty())  // else it is of the gateway itself
            boards.insert(change->board);
    }
    if (lost) {
        const auto names = gateway_.mirror().board_names();
        export_->changed({names.begin(), names.end()}, now);
    } else if (!boards.empty()) {
        changed(std::move(boards), now);
    }
}

// Each look costs messages and their acknowledgements: of a board that changes all the time the newest state
// counts.
void Exports::changed(std::set<std::string> boards, Time now) {
    for (auto board = boards.begin(); board != boards.end();) {
        const auto next = std::next(board);
        if (!looks_.take(*board, now)) later_.insert(boards.extract(board));
        board = next;
    }
    export_->changed(std::move(boards), now);
}

void Exports::message_of_service(const bus::TopicRef& topic, const mqtt::Message& message) {
    if (topic.kind == TopicKind::kServiceOut)
        export_->value(topic.board, topic.service, message.payload, gateway_.now().time);
}

void Exports::message(const mqtt::Message& message) {
    export_->message(message, gateway_.now().time);
}

void Exports::tick() {
    const auto now = gateway_.now().time;
    looks_.expire(now);
    if (!later_.empty()) changed(std::exchange(later_, {}), now);
    changes();
    connection_.tidy();
    export_->tick(now);
}

void Exports::stop(Duration limit, std::function<void()> done) {
    export_->leave();
    connection_.stop(limit, std::move(done));
}

}  // namespace asip::gateway
