// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/group_command.hpp"

#include <list>
#include <nlohmann/json.hpp>
#include <ostream>

#include "asip/model/json.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/side_by_side.hpp"
#include "cli/find/target.hpp"
#include "cli/text/table.hpp"

namespace asip::cli {
namespace {

class GroupSender {
  public:
    GroupSender(const GroupCommand& group, Environment& environment, BusSession& session, BoardSource& source)
        : group_(group), environment_(environment), session_(session), source_(source) {}

    int run() {
        if (const auto prepared = prepare(); !prepared) return environment_.fail_with(prepared.error());
        if (group_.no_wait) {
            for (const auto& member : members_)
                if (!member.reply) session_.publish(member.command.topic, member.command.payload, 1);
            return report_unsent();
        }
        send_all();
        return report();
    }

  private:
    struct Member {
        std::string board;
        BoardCommand command;
        std::optional<bus::Reply> reply{};
        BusSession::Call call{};
    };

    Outcome<BoardCommand> command_for(const KnownBoard& board) const {
        if (!group_.raw.empty()) {
            auto command = make_raw_command(environment_, board.item.board, group_.raw);
            if (command) command->plain = board.item.names_only;
            return command;
        }
        const auto service = find_service(board, group_.target.service);
        if (!service) return tl::unexpected(service.error());
        return make_command(environment_, board, *service, group_.words);
    }

    Outcome<void> prepare() {
        const auto boards = choose_boards(source_, group_.target, group_.labels);
        if (!boards) return tl::unexpected(boards.error());
        std::string offline;
        for (const auto& board : *boards) {
            const auto& name = board.item.board;
            if (board.item.state == "offline") {
                offline += (offline.empty() ? "" : ", ") + name;
                continue;
            }
            auto command = command_for(board);
            if (!command) return tl::unexpected(command.error());
            auto& member = members_.emplace_back(Member{name, std::move(*command)});
            if (board.item.state == "lost") member.reply = refused_as_lost(board.item, "nothing was sent");
        }
        if (!offline.empty()) environment_.note("offline, left out: " + offline);
        if (members_.empty()) return failure(program::kExitNoAnswer, "none of these boards is there");
        return {};
    }

    void send_all() {
        std::list<Member*> there;
        for (auto& member : members_)
            if (!member.reply) there.push_back(&member);
        ask_side_by_side(
            session_, std::move(there), group_.in_flight,
            [this](Member& member) {
                member.call = session_.command(member.command.to_send(),
                                               [&member](const bus::Reply& reply) { member.reply = reply; });
                return Time::max();
            },
            [](const Member& member) { return member.reply.has_value(); });
    }

    int report_unsent() const {
        int status = program::kExitOk;
        for (const auto& member : members_) {
            if (!member.reply) continue;
            environment_.note(member.board + ": " + member.reply->error);
            status = program::kExitFailure;
        }
        return status;
    }

    int report() {
        int status = program::kExitOk;
        std::size_t executed = 0;
        RecordPrinter records(group_.output, RecordPrinter::Count::kList, environment_.out);
        Table table({{"BOARD"}, {"RESULT"}, {"ANSWER", false, 10}});
        for (const auto& member : members_) {
            const auto reply = member.reply.value_or(not_waited_for());
            const bool ok = reply.succeeded();
            if (ok) ++executed;
            if (!ok && status == program::kExitOk) status = exit_status(reply);
            if (!group_.output.for_people()) {
                auto record = *model::parse_json(bus::to_json_text(reply));
                record["board"] = member.board;
                record["target"] = member.command.target;
                record["line"] = member.command.line;
                records.print(record);
                continue;
            }
            table.add({member.board,
                       Cell(std::string(bus::to_string(reply.status)), ok ? Colour::kGreen : Colour::kRed),
                       ok ? (reply.answer.empty() ? "" : answer_text(reply)) : why_not(reply)});
        }
        records.finish();
        if (group_.output.for_people())
            environment_.out << table.render(environment_.width, environment_.colour) << std::flush;
        if (status != program::kExitOk)
            environment_.note(std::to_string(executed) + " of " + std::to_string(members_.size()) +
                              " boards executed it");
        return status;
    }

    const GroupCommand& group_;
    Environment& environment_;
    BusSession& session_;
    BoardSource& source_;
    std::list<Member> members_;
};

}  // namespace

int send_to_group(const GroupCommand& group, Environment& environment, BusSession& session,
                  BoardSource& source) {
    if (group.target.service.find_first_of("*?") != std::string::npos)
        return environment.fail_with(
            {program::kExitUsage, "'" + group.target.service + "': name one service of the boards"});
    if (group.target.service.empty() && group.raw.empty())
        return environment.fail_with({program::kExitUsage, "which service? Write " + group.target.board +
                                                               "/SERVICE COMMAND ..., or --raw LINE"});
    return GroupSender(group, environment, session, source).run();
}

}  // namespace asip::cli
