// SPDX-License-Identifier: Apache-2.0
#include "cli/forget_request.hpp"

#include <optional>

namespace asip::cli {

Outcome<Forgotten> ask_to_forget(const Context& context, BusSession& session, BoardSource& source,
                                 const std::string& board) {
    const auto registry = source.registry().empty() ? source.find_registry() : source.registry();
    if (registry.empty()) return Forgotten::kNoRegistry;
    std::optional<Expected<bus::Answer>> answer;
    bus::RegistryRequest request;
    request.what = bus::Forget{board, false};
    const auto asked =
        session.ask(context.topics.registry_query(registry), bus::encode(request),
                    [&answer](const mqtt::Message& message) { answer = bus::parse_answer(message.payload); });
    session.run_until([&answer] { return answer.has_value(); }, Clock::now() + context.timeout);
    if (!answer || !*answer)
        return failure(program::kExitNoAnswer, "registry " + registry + " did not answer");
    const auto& refused = (*answer)->refused;
    if (refused == "unknown-board") return Forgotten::kUnknownBoard;
    if (!refused.empty())
        return failure(program::kExitFailure, "registry " + registry + ": " + (*answer)->error);
    return Forgotten::kYes;
}

}  // namespace asip::cli
