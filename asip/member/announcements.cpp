// SPDX-License-Identifier: Apache-2.0
#include "asip/member/announcements.hpp"

#include <utility>

#include "asip/bus/request/reply_topics.hpp"

namespace asip::member {

mqtt::Message retained(std::string topic, std::string payload) {
    mqtt::Message message;
    message.topic = std::move(topic);
    message.payload = std::move(payload);
    message.qos = 1;
    message.retain = true;
    return message;
}

std::vector<std::string> take_stray_answers(Publications& publish, const bus::Topics& topics,
                                            std::string_view board) {
    std::vector<std::string> taken;
    std::erase_if(publish, [&](const Publication& each) {
        const bool answer =
            each.priority == mqtt::Priority::kReply || each.priority == mqtt::Priority::kUrgent;
        if (!answer || bus::may_answer_on(each.message.topic, topics, board)) return false;
        taken.push_back(each.message.topic);
        return true;
    });
    return taken;
}

}  // namespace asip::member
