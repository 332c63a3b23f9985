#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asip/mqtt/message.hpp"
#include "asip/program/log.hpp"
#include "asip/session/action.hpp"

namespace asip::agent {

struct Publication {
    mqtt::Message message;
    mqtt::Priority priority = mqtt::Priority::kContext;
};
using Publications = std::vector<Publication>;

/// Something a person may want to read in the log.
struct Notice {
    program::log::Level level = program::log::Level::kInfo;
    std::string text;
    std::vector<std::pair<std::string, std::string>> fields;
};

/// Why the program has to end, and with which status.
struct Fatal {
    int status = 1;
    std::string text;
};

/// A line for one point-to-point client, or for all of them.
struct ClientLine {
    std::string line;
    std::optional<session::ClientId> client;
};

/// What the pure bridge wants done, in order within each list; across lists the order does not matter.
struct Effects {
    std::vector<session::Action> link;  ///< Write and SetLineRate only
    Publications publish;
    std::vector<ClientLine> lines;  ///< for point-to-point clients
    std::vector<Notice> notices;
    bool board_known = false;   ///< the board was identified (again): its name is known now
    bool name_claimed = false;  ///< the board's name is ours now: commands may come
    bool reopen_link = false;   ///< open, but the board behind it is gone: a connection may be dead
    std::optional<Fatal> fatal;

    void log(program::log::Level level, std::string text,
             std::vector<std::pair<std::string, std::string>> fields = {}) {
        notices.push_back(Notice{level, std::move(text), std::move(fields)});
    }
};

}  // namespace asip::agent
