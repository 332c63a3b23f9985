// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/sources.hpp"

#include "asip/links/shown.hpp"
#include "cli/ask/board_request.hpp"
#include "cli/ask/retained.hpp"
#include "cli/secure/actions.hpp"
#include "cli/secure/folder.hpp"
#include "cli/secure/reload.hpp"
#include "cli/secure/users.hpp"

namespace asip::cli {

std::string source_rules(const SecuredBus& bus) {
    const bus::Topics topics(bus.topic_root);
    std::string text;
    for (const auto& [board, sources] : bus.reads) {
        text += "\n# The agent of " + board + " hears the sources of its links.\nuser " + board + "\n";
        for (const auto& source : sources) {
            for (const auto& topic :
                 {topics.state(source), topics.description(source), topics.properties(source),
                  topics.values(source), topics.service_out(source, "+")})
                text += "topic read " + topic + "\n";
            text += "topic write " + topics.demand(source, board + "/+") + "\n";
        }
    }
    return text;
}

std::vector<Trial> source_trials(const SecuredBus& bus, const std::string& board,
                                 const std::string& stranger) {
    const bus::Topics topics(bus.topic_root);
    std::vector<Trial> made{
        {board, "hear boards that are no sources", false, {}, {topics.service_out(stranger, kNoService)}}};
    if (const auto found = bus.reads.find(board); found != bus.reads.end())
        for (const auto& source : found->second)
            made.push_back({board, "hear " + source, true, {}, {topics.service_out(source, kNoService)}});
    return made;
}

Outcome<void> secure_link(const SecureOptions& options, SecureReport& report) {
    const bool gives = options.action == "link";
    if (options.what.empty() || options.names.empty())
        return failure(program::kExitUsage, "write asipctl secure " + options.action + " BOARD SOURCE");
    const auto folder = SecureFolder::open(secure_folder(options));
    if (!folder) return tl::unexpected(folder.error());
    auto bus = folder->bus();
    if (!bus) return tl::unexpected(bus.error());
    auto boards = options.names;
    boards.push_back(options.what);
    for (const auto& name : boards) {
        if (auto known = check_known(*bus, name); !known) return known;
        if (bus->find(name)->role != Role::kBoard)
            return failure(program::kExitUsage,
                           name + " is no board, but " + std::string(name_of(bus->find(name)->role)));
    }
    auto& sources = bus->reads[options.what];
    for (const auto& name : options.names) {
        const bool changed = gives ? sources.insert(name).second : sources.erase(name) > 0;
        report.did(changed ? "changed" : "kept",
                   "the agent of " + options.what + (gives ? " may hear " : " does not hear ") + name);
    }
    if (sources.empty()) bus->reads.erase(options.what);
    if (auto done = write_users(*folder, *bus); !done) return done;
    report_reload(*folder, *bus, options.reload_pid, report);
    return {};
}

void clear_links(const Environment& admin, BusSession& session, const std::string& user,
                 const std::string& folder, SecureReport& report) {
    const auto retained = read_retained(admin, session, {admin.topics.links("+")});
    if (!retained)
        return report.next("the links that " + user + " set are not known: " + retained.error().text +
                               ". When the broker answers, repeat",
                           "asipctl secure revoke " + user + " --dir " + folder);
    std::set<std::string> boards;
    for (const auto& message : *retained)
        if (const auto topic = admin.topics.parse(message.topic))
            for (const auto& each : links::read_shown(topic->board, message.payload))
                if (each.link.user == user) boards.insert(each.board);
    for (const auto& board : boards) {
        const auto reply = ask_board(
            session, {.topic = admin.topics.link(board, user + "/revoke"), .payload = R"({"remove":"*"})"});
        if (reply && reply->succeeded())
            report.did("removed", "the links that " + user + " set at " + board);
        else
            report.next("the agent of " + board + " was not reached: the links that " + user +
                            " set there go on. When it is back, repeat",
                        "asipctl secure revoke " + user + " --dir " + folder);
    }
}

}  // namespace asip::cli
