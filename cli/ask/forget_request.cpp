// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/forget_request.hpp"

#include <optional>
#include <string_view>

#include "asip/bus/registry/query.hpp"

namespace asip::cli {
namespace {

constexpr std::string_view kUnknownBoard = "unknown-board";

/// Whether it has forgotten the board; false: it knows no such board.
Outcome<bool> ask(const Environment& environment, BusSession& session, const std::string& registry,
                  const std::string& board) {
    std::optional<Expected<bus::Answer>> answer;
    bus::RegistryRequest request;
    request.what = bus::Forget{board, false};
    const auto asked =
        session.ask(bus::forget_topic(environment.topics, registry), bus::encode(request),
                    [&answer](const mqtt::Message& message) { answer = bus::parse_answer(message.payload); });
    session.run_until([&answer] { return answer.has_value(); }, Clock::now() + environment.timeout);
    if (session.stopped()) return interrupted();
    if (!answer || !*answer)
        return tl::unexpected(session.unanswered("registry " + registry + " did not answer"));
    const auto& refused = (*answer)->refused;
    if (!refused.empty() && refused != kUnknownBoard)
        return failure(program::kExitFailure, "registry " + registry + ": " + (*answer)->error);
    return refused.empty();
}

}  // namespace

AskedToForget ask_to_forget(const Environment& environment, BusSession& session, BoardSource& source,
                            const std::vector<std::string>& boards) {
    AskedToForget result;
    if (boards.empty()) return result;
    const auto registry = source.registry().empty() ? source.find_registry() : source.registry();
    if (registry.empty()) return result;
    for (const auto& board : boards) {
        // One that does not answer is not waited for once for each board.
        if (result.status == program::kExitNoAnswer || result.status == program::kExitBroker) {
            result.refused.insert(board);
            continue;
        }
        const auto forgotten = ask(environment, session, registry, board);
        if (!forgotten) {
            result.status = environment.fail_with(forgotten.error());
            result.refused.insert(board);
        } else if (*forgotten) {
            result.forgotten.insert(board);
        }
    }
    return result;
}

}  // namespace asip::cli
