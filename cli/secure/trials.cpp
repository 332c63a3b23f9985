// SPDX-License-Identifier: Apache-2.0
#include "cli/secure/trials.hpp"

#include "asip/bus/request/request_envelope.hpp"
#include "asip/bus/topics.hpp"

namespace asip::cli {

std::vector<Trial> trials_of(const RoleOfUser& user, const std::string& root, const std::string& stranger) {
    const bus::Topics topics(root);
    const bool board = user.role == Role::kBoard;
    const bool admin = user.role == Role::kAdmin;
    const bool registry = user.role == Role::kRegistry;
    const bool home = user.role == Role::kHomeAssistant;
    const bool commands =
        admin || (user.role == Role::kOperator && !user.boards) || user.role == Role::kGateway;
    const std::vector<std::string> requests{topics.board_in(stranger), topics.service_in(stranger, "io"),
                                            topics.stop(stranger)};
    const std::vector<std::string> values{topics.board_out(stranger), topics.service_out(stranger, "io"),
                                          topics.service_error(stranger, "io")};
    const std::vector<std::string> announcements{topics.state(stranger), topics.description(stranger),
                                                 topics.service_names(stranger)};
    const auto answers = [&](const std::string& asked) {
        return bus::ReplyTopics(topics, stranger, "check").to(topics.board_in(asked));
    };

    std::vector<Trial> made;
    const auto publish = [&](const char* what, bool allowed, std::vector<std::string> where) {
        made.push_back({user.name, what, allowed, std::move(where), {}});
    };
    const auto read = [&](const char* what, bool allowed, std::vector<std::string> where) {
        made.push_back({user.name, what, allowed, {}, std::move(where)});
    };
    if (board) {
        // A message that says nothing is of no account there.
        publish("announce its own board", true, {topics.commands(user.name)});
    }
    if (registry) {
        publish("clear what boards left", true, announcements);
        publish("clear what boards reported", true, values);
        publish("answer queries", true, {answers("registry")});
    } else {
        publish("announce other boards", admin, announcements);
        publish("report for other boards", admin, values);
    }
    // An administrator may, but would put a nameless board onto the bus.
    if (!admin) publish("name boards on the shared topic", false, {topics.board_names()});
    publish("answer for other boards", admin, {answers(stranger)});
    publish("command boards", commands, requests);
    if (user.boards)
        for (const auto& name : *user.boards)
            made.push_back({user.name, "command " + name, true, {topics.service_in(name, kNoService)}, {}});
    if (!registry) {
        publish("demand values", !board && !home, {topics.demand(stranger, user.name + "/check")});
        publish("set links", commands, {topics.link(stranger, user.name + "/check")});
        publish("set links in another's name", admin, {topics.link(stranger, stranger + "/check")});
        publish("demand values in another's name", admin, {topics.demand(stranger, stranger + "/check")});
    }
    if (!board) read("read what boards report", !home, values);
    if (admin || home || user.role == Role::kGateway) {
        const std::string exported = root + "/export/ha/" + stranger + "/x";
        if (!home) publish("export boards to Home Assistant", true, {exported});
        publish("set what is exported", true, {exported + "/set"});
        read("read what is exported", true, {exported});
    }
    const std::vector<std::string> dashboard{root + "/export/dashboard/" + stranger};
    publish("keep dashboards", admin || user.role == Role::kGateway, dashboard);
    read("read dashboards and their links",
         admin || user.role == Role::kGateway || user.role == Role::kRegistry, dashboard);
    read("read what others are asked", admin, requests);
    read("read answers to others", admin, {answers(stranger)});
    return made;
}

}  // namespace asip::cli
