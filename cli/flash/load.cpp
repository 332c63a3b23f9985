// SPDX-License-Identifier: Apache-2.0
#include "cli/flash/load.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/request/agent_requests.hpp"
#include "asip/model/json.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

using namespace std::chrono_literals;

/// Longer than an agent tries each boot loader and waits for the board.
constexpr std::chrono::milliseconds kLoadPatience = 6min;

std::string by_of(const Environment& environment) {
    return (who_asks(environment) + " by " + environment.mqtt.client_id).substr(0, 64);
}

}  // namespace

Load::Load(const Environment& environment, BusSession& session, const std::string& board,
           const LoadOptions& options)
    : call_(session.command({.topic = environment.topics.board_in(board),
                             .payload = bus::encode({.what = bus::PortRequest::What::kLoad,
                                                     .firmware = options.firmware,
                                                     .board = options.board,
                                                     .force = options.force,
                                                     .update = options.update},
                                                    by_of(environment)),
                             .deadline = kLoadPatience,
                             .lasts = true},
                            [this](const bus::Reply& reply) { reply_ = reply; })) {}

std::string Load::progress(std::string_view description) {
    const auto document = model::parse_json(description);
    if (!document || value_at(*document, "updating.step").empty()) return {};
    const auto step = for_terminal(value_at(*document, "updating.step"));
    const auto percent = value_at(*document, "updating.percent");
    return step == "writing" || step == "verifying" ? step + " " + for_terminal(percent) + " %" : step;
}

int run_load(const LoadOptions& options, const std::string& board, const OutputOptions& output,
             Environment& environment) {
    BusSession session(environment);
    BoardSource source(environment, session);
    std::string shown;
    const auto descriptions =
        session.subscribe(environment.topics.description(board), [&](const mqtt::Message& message) {
            const auto now = Load::progress(message.payload);
            if (now.empty() || now == shown || message.retain) return;
            shown = now;
            environment.note(board + ": " + now);
        });
    if (const auto connected = session.connect(); !connected) return environment.fail_with(connected.error());
    const auto fail = [&](const Failure& failure) {
        print_failure(output, RecordPrinter::Count::kOne, board, failure, environment.out);
        return environment.fail_with(failure);
    };
    if (const auto known = source.board(board); !known) return fail(known.error());
    const Load load(environment, session, board, options);
    session.run_until([&] { return load.reply().has_value(); }, Time::max());
    if (!load.reply())
        return fail({program::kExitFailure, "interrupted; the agent goes on, and takes the port back"});
    const auto& reply = *load.reply();
    if (!reply.succeeded()) return fail(failure_of(reply, board + ": "));
    const auto document = model::parse_json(reply.answer).value_or(nlohmann::json::object());
    const auto sketch = value_at(document, "after.sketch");
    if (output.for_people()) {
        environment.say(board + ": " + sketch + " on " + value_at(document, "after.chip"));
    } else {
        RecordPrinter(output, RecordPrinter::Count::kOne, environment.out)
            .print({{"board", board},
                    {"programmed", true},
                    {"same", value_at(document, "same") == "true"},
                    {"sketch", sketch},
                    {"was", value_at(document, "before.sketch")},
                    {"chip", value_at(document, "after.chip")}});
    }
    return program::kExitOk;
}

}  // namespace asip::cli
