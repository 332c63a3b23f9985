// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "asip/mqtt/client.hpp"

/// What a ClientCore has its caller do, and what it has the caller tell the program, in order.
namespace asip::mqtt::action {

/// Find the broker's address and connect. Ends in connection_up() or connection_down().
struct Connect {
    BrokerAddress broker{};
    bool v5 = true;
    std::string client_id{};
    std::optional<Message> will{};
};

/// Send SUBSCRIBE, then call subscribe_sent().
struct Subscribe {
    std::string filter;
    SubscribeOptions options{};
};

/// Send UNSUBSCRIBE.
struct Unsubscribe {
    std::string filter;
};

/// Send UNSUBSCRIBE of a filter that the client never subscribed to, then call check_sent().
struct Check {};

/// Send the message ClientCore::to_send(), then call publish_sent().
struct Publish {};

/// Send DISCONNECT. connection_down() follows.
struct Goodbye {};

/// End the connection without DISCONNECT. connection_down() follows, with this failure.
struct Fail {
    ConnectionFailure failure;
};

/// End the connection or the attempt without DISCONNECT. No call about it follows.
struct Abandon {};

// What the program is told: see Client::Handlers.

struct Established {
    Connected connected;
};
struct Lost {
    ConnectionFailure failure;
};
struct AttemptFailed {
    ConnectionFailure failure;
};
struct Published {
    std::string topic;
};
struct PublishDenied {
    std::string topic;
    std::string reason;
};
struct Subscribed {};
struct SubscribeRefused {
    std::string filter;
    std::string reason;
};
struct CheckAnswered {};
struct Debug {
    std::string line;
};
/// stop() is complete.
struct Stopped {};

using Action = std::variant<Connect, Subscribe, Unsubscribe, Check, Publish, Goodbye, Fail, Abandon,
                            Established, Lost, AttemptFailed, Published, PublishDenied, Subscribed,
                            SubscribeRefused, CheckAnswered, Debug, Stopped>;

}  // namespace asip::mqtt::action

namespace asip::mqtt {

using Actions = std::vector<action::Action>;

}  // namespace asip::mqtt
