// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/reply_topics.hpp"

#include <algorithm>

namespace asip::bus {
namespace {

constexpr std::string_view kServiceBus = "servicebus/";

bool can_be_level(std::string_view text) {
    return !text.empty() && std::none_of(text.begin(), text.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte < 0x20 || byte == 0x7f || c == '+' || c == '#' || c == '/';
    });
}

}  // namespace

std::string user_level(std::string_view user) {
    return std::string(can_be_level(user) ? user : "$nobody");
}

ReplyTopics::ReplyTopics(const Topics& topics, std::string_view user, std::string_view client)
    : root_(topics.root() + "/"),
      prefix_(root_ + "reply/" + user_level(user) + "/"),
      client_("/" + std::string(client)) {}

ReplyTopics ReplyTopics::below(std::string_view level) const {
    ReplyTopics made = *this;
    made.client_.append("/").append(level);
    return made;
}

ReplyTopics ReplyTopics::beside(std::string_view suffix) const {
    ReplyTopics made = *this;
    made.client_.append("-").append(suffix);
    return made;
}

std::string_view ReplyTopics::asked(std::string_view request_topic) const {
    if (request_topic.starts_with(root_)) request_topic.remove_prefix(root_.size());
    // A demand stands on the service bus, and the board answers it.
    if (request_topic.starts_with(kServiceBus)) request_topic.remove_prefix(kServiceBus.size());
    return request_topic.substr(0, request_topic.find('/'));
}

bool ReplyTopics::have(std::string_view topic) const {
    if (!of_user(topic)) return false;
    topic.remove_prefix(prefix_.size());
    const auto level = topic.find('/');
    return level != std::string_view::npos && topic.substr(level) == client_;
}

std::string ReplyTopics::of(std::string_view asked) const {
    return std::string(prefix_).append(asked).append(client_);
}

bool may_answer_on(std::string_view topic, const Topics& topics, std::string_view answerer) {
    const auto below = topics.root() + "/reply/";
    if (!topic.starts_with(below)) return false;
    topic.remove_prefix(below.size());
    const auto user = topic.find('/');
    if (user == 0 || user == std::string_view::npos) return false;
    topic.remove_prefix(user + 1);
    return topic.size() > answerer.size() + 1 && topic.starts_with(answerer) && topic[answerer.size()] == '/';
}

}  // namespace asip::bus
