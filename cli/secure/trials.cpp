#include "cli/secure/trials.hpp"

#include "asip/bus/topics.hpp"

namespace asip::cli {

std::vector<Trial> trials_of(const RoleOfUser& user, const std::string& root, const std::string& stranger) {
    const bus::Topics topics(root);
    const bool board = user.role == Role::kBoard;
    const bool admin = user.role == Role::kAdmin;
    const bool registry = user.role == Role::kRegistry;
    const bool commands = admin || user.role == Role::kOperator || user.role == Role::kGateway;
    const std::vector<std::string> requests{topics.board_in(stranger), topics.service_in(stranger, "io"),
                                            topics.stop(stranger)};
    const std::vector<std::string> values{topics.board_out(stranger), topics.service_out(stranger, "io"),
                                          topics.service_error(stranger, "io")};
    const std::vector<std::string> announcements{topics.state(stranger), topics.description(stranger),
                                                 topics.service_names(stranger)};
    const auto answers = topics.reply(stranger, "check");

    std::vector<Trial> made;
    const auto publish = [&](const char* what, bool allowed, std::vector<std::string> where) {
        made.push_back({user.name, what, allowed, std::move(where), {}});
    };
    const auto read = [&](const char* what, bool allowed, std::vector<std::string> where) {
        made.push_back({user.name, what, allowed, {}, std::move(where)});
    };
    if (board) {
        // A topic of its own that nobody reads.
        publish("announce its own board", true, {topics.service_names(user.name) + "/$check"});
    }
    publish("announce other boards", admin || registry, announcements);
    publish("report for other boards", admin || registry, values);
    if (registry) {
        publish("clear retained commands", true, requests);
    } else {
        publish("command boards", commands, requests);
    }
    if (!board) read("read what boards report", true, values);
    read("read what others are asked", admin || registry, requests);
    read("read answers to others", admin || registry, {answers + "/" + stranger});
    return made;
}

}  // namespace asip::cli
