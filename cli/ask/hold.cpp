// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/hold.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/model/json.hpp"

namespace asip::cli {
namespace {

/// At Ctrl-C, for the answer of the board.
constexpr std::chrono::seconds kLastPatience{2};

class Hold {
  public:
    Hold(Environment& environment, BusSession& session, const BoardCommand& command,
         std::chrono::milliseconds hold, const OutputOptions& output)
        : environment_(environment),
          session_(session),
          command_(command),
          hold_(hold),
          output_(output),
          records_(output, RecordPrinter::Count::kStream, environment.out) {}

    int run(std::optional<std::chrono::milliseconds> during) {
        std::optional<bus::Reply> begun, ended;
        auto hold = session_.hold(
            command_.to_send(), hold_, [&begun](const bus::Reply& reply) { begun = reply; },
            [&ended](const bus::Reply& reply) { ended = reply; });
        session_.run_until([&] { return begun.has_value(); }, Time::max());
        if (!begun) return undo();  // it may be executed all the same
        print(command_.line, *begun);
        if (!begun->succeeded()) return environment_.fail_with(failure_of(*begun, command_.line + ": "));
        session_.run_until([&] { return ended.has_value(); }, during ? Clock::now() + *during : Time::max());
        if (ended) return environment_.fail_with(failure_of(*ended, command_.line + ": "));
        hold.reset();
        return undo();
    }

  private:
    int undo() {
        BoardCommand undoing = command_;
        undoing.payload = command_.safe.substr(std::min<std::size_t>(2, command_.safe.size()));
        undoing.line = command_.safe;
        const auto reply =
            session_.stopped() ? ask_at_the_end(undoing) : ask_board(session_, undoing.to_send());
        if (!reply) return environment_.fail_with(reply.error());
        print(undoing.line, *reply);
        if (reply->succeeded()) return program::kExitOk;
        return environment_.fail_with(failure_of(*reply, undoing.line + ": "));
    }

    Outcome<bus::Reply> ask_at_the_end(const BoardCommand& undoing) {
        std::optional<bus::Reply> reply;
        const auto call =
            session_.command(undoing.to_send(), [&reply](const bus::Reply& answer) { reply = answer; });
        if (session_.run_to_end([&reply] { return reply.has_value(); }, kLastPatience)) return *reply;
        auto failed = session_.unanswered("no answer");
        failed.text = undoing.line + " is not confirmed (" + failed.text +
                      "); were it lost, the agent would undo the command within " +
                      std::to_string(hold_.count()) + " ms";
        return tl::unexpected(std::move(failed));
    }

    void print(const std::string& line, const bus::Reply& reply) {
        if (output_.for_people()) {
            if (reply.succeeded()) environment_.say(line + ": " + answer_text(reply));
            return;
        }
        auto record = *model::parse_json(bus::to_json_text(reply));
        record["target"] = command_.target;
        record["line"] = line;
        records_.print(record);
    }

    Environment& environment_;
    BusSession& session_;
    const BoardCommand& command_;
    std::chrono::milliseconds hold_;
    const OutputOptions& output_;
    RecordPrinter records_;
};

}  // namespace

int hold_command(Environment& environment, BusSession& session, const BoardCommand& command,
                 std::chrono::milliseconds hold, std::optional<std::chrono::milliseconds> during,
                 const OutputOptions& output) {
    if (command.safe.empty())
        return environment.fail_with(
            {program::kExitUsage, command.target + ": nothing undoes " + command.line +
                                      ", so --hold does not apply; see asipctl model KIND"});
    if (hold < bus::kMinHold || hold > bus::kMaxHold)
        return environment.fail_with({program::kExitUsage, "--hold takes 50ms to 60s"});
    return Hold(environment, session, command, hold, output).run(during);
}

}  // namespace asip::cli
