// SPDX-License-Identifier: Apache-2.0
#include "cli/flash/lent_port.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/request/reply.hpp"
#include "asip/model/json.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/output.hpp"

namespace asip::cli {
namespace {

// The agent itself waits up to 20 s for the board.
constexpr std::chrono::milliseconds kBoardPatience{26'000};

nlohmann::json document_of(const std::string& text) {
    auto document = model::parse_json(text);
    return document && document->is_object() ? std::move(*document) : nlohmann::json::object();
}

}  // namespace

Outcome<KnownBoard> find_board_with_agent(BoardSource& source, const std::string& name) {
    auto board = source.board(name);
    if (board && board->item.state == "offline")
        return failure(program::kExitFailure,
                       name + " is offline: its agent has ended, and no program has its port");
    return board;
}

LentPort::LentPort(const Environment& environment, BusSession& session, std::string board)
    : environment_(environment),
      session_(session),
      board_(std::move(board)),
      by_((who_asks(environment) + " by " + environment.mqtt.client_id).substr(0, 64)) {}

Outcome<std::string> LentPort::ask(const bus::PortRequest& request, std::chrono::milliseconds patience) {
    // A port is not released when no command waits for it any more; it is taken back however late that comes.
    const auto reply = ask_board(session_, {.topic = environment_.topics.board_in(board_),
                                            .payload = bus::encode(request, by_),
                                            .deadline = patience,
                                            .lasts = request.what != bus::PortRequest::What::kRelease});
    if (!reply) return tl::unexpected(reply.error());
    const auto& answer = *reply;
    if (answer.succeeded()) return answer.answer;
    if (answer.reason == bus::kRefusedInvalid)
        return failure(program::kExitFailure, "the agent of " + board_ +
                                                  " cannot release its port; is it of an "
                                                  "earlier version? (" +
                                                  answer.error + ")");
    return tl::unexpected(failure_of(answer, board_ + ": "));
}

Outcome<ReleasedPort> LentPort::release(std::chrono::seconds time) {
    const auto answer = ask({bus::PortRequest::What::kRelease, time}, environment_.timeout);
    if (!answer) return tl::unexpected(answer.error());
    const auto document = document_of(*answer);
    return ReleasedPort{value_at(document, "kind"), value_at(document, "path"),
                        value_at(document, "host"), value_at(document, "until"),
                        value_at(document, "chip"), value_at(document, "sketch")};
}

void LentPort::prolong(std::chrono::seconds time) {
    session_.publish(environment_.topics.board_in(board_),
                     bus::encode({bus::PortRequest::What::kRelease, time}, by_), 1);
}

Outcome<TakenPort> LentPort::give_back() {
    const auto answer =
        ask({bus::PortRequest::What::kTake, {}}, std::max(environment_.timeout, kBoardPatience));
    if (!answer) return tl::unexpected(answer.error());
    const auto document = document_of(*answer);
    return TakenPort{document.value("same", nlohmann::json()) == true, value_at(document, "before.sketch"),
                     value_at(document, "after.sketch"), value_at(document, "after.chip")};
}

void LentPort::give_back_unseen() {
    session_.publish(environment_.topics.board_in(board_),
                     bus::encode({bus::PortRequest::What::kTake, {}}, by_), 1);
}

}  // namespace asip::cli
