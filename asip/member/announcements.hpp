// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/program/log.hpp"

namespace asip::member {

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

/// What a member of the bus wants done.
struct Announcements {
    Publications publish;
    std::vector<Notice> notices;
    std::optional<Fatal> fatal;

    void log(program::log::Level level, std::string text,
             std::vector<std::pair<std::string, std::string>> fields = {}) {
        notices.emplace_back(level, std::move(text), std::move(fields));
    }
};

/// A message that the broker keeps; of an empty payload: it keeps none there any more.
mqtt::Message retained(std::string topic, std::string payload = {});

/// Takes out the answers (Priority::kReply and kUrgent) for which bus::may_answer_on() is false. Returns
/// their topics.
std::vector<std::string> take_stray_answers(Publications& publish, const bus::Topics& topics,
                                            std::string_view board);

}  // namespace asip::member
