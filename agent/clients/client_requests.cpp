// SPDX-License-Identifier: Apache-2.0
#include "agent/clients/client_requests.hpp"

#include <set>
#include <string>

#include "agent/command/control.hpp"
#include "asip/protocol/extensions.hpp"
#include "asip/protocol/message.hpp"
#include "asip/session/request.hpp"

namespace asip::agent {

namespace {

using session::Ending;

constexpr const char* kDoubt = "~#,C,10{BAD_CHECKSUM}";

// That such a board has read something else shows in the answer to a fence behind it, and not before.
bool is_verified(const session::Identity& board) {
    return board.extensions.has(protocol::kVerifiedFence);
}

// Rate, checksums and digests are between the board and the agent.
std::string extensions_for_clients(const session::Identity& board) {
    constexpr std::string_view kOfTheLine{"BCV"};
    std::string list;
    int count = 0;
    for (const auto& [tag, version] : board.extensions.list) {
        if (kOfTheLine.find(tag) != kOfTheLine.npos) continue;
        list += (list.empty() ? "" : ",") + std::string{tag, ':'} + std::to_string(version);
        ++count;
    }
    return "@#,X," + std::to_string(count) + ",{" + list + "}";
}

std::string answer_for_clients(const protocol::ParsedLine& line, const session::Identity& board) {
    const auto event = line.event();
    return event.service == '#' && event.tag == 'X' ? extensions_for_clients(board) : line.text();
}

}  // namespace

session::RequestOptions ClientRequests::options(session::ClientId client, const protocol::Request& request,
                                                const session::Identity& board) const {
    session::RequestOptions options{.client = client, .prove = false};
    if (!is_verified(board) || !session::is_question(request.service, request.tag)) return options;
    options.prove = true;
    options.answer_tag = request.tag;
    return options;
}

void ClientRequests::on_line(const session::BoardLine& line, const session::Identity& board,
                             Effects& out) const {
    if (!line.owner) return out.lines.push_back({line.line.text(), std::nullopt});
    if (*line.owner & kBusClient) return;
    if (!line.line.is_event()) return out.lines.push_back({line.line.text(), line.owner});
    if (!is_verified(board)) out.lines.push_back({answer_for_clients(line.line, board), line.owner});
}

void ClientRequests::on_garbage(Effects& out) const {
    std::set<session::ClientId> clients;
    for (const auto& [id, client] : open_)
        if (clients.insert(client).second) out.lines.push_back({kDoubt, client});
}

void ClientRequests::on_finished(const session::Finished& end, const session::Identity& board, Effects& out) {
    const auto known = open_.extract(end.id);
    if (known.empty() || end.ending == Ending::kUnproven || end.ending == Ending::kBoardError) return;
    if (end.ending != Ending::kExecuted) return out.lines.push_back({kDoubt, known.mapped()});
    if (!end.answer.empty()) out.lines.push_back({answer_for_clients(end.answer, board), known.mapped()});
}

}  // namespace asip::agent
