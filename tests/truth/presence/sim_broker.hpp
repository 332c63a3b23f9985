// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <unordered_map>
#include <vector>

#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"
#include "tests/support/dice.hpp"

namespace truth::presence {

using asip::Duration;
using asip::Time;
using asip::mqtt::Message;
using asip::test::Dice;

/// An MQTT 5 broker in simulated time: it retains, lets messages expire, publishes wills, and delivers each
/// message after a random time; to one client in the order in which they came, or, `in_order` false, only
/// those of one topic in their order, as bridged brokers do. There, too, a will comes behind all that its
/// client sent: it takes the same way.
class SimBroker {
  public:
    using Client = int;
    using Receive = std::function<void(const Message&, Time)>;

    SimBroker(Dice& dice, bool in_order) : dice_(dice), in_order_(in_order) {}

    Client connect(Receive receive, std::optional<Message> will = std::nullopt);
    void subscribe(Client client, const std::string& filter, bool no_local, bool retained, Time now);
    void unsubscribe(Client client, const std::string& filter);
    void publish(Client from, Message message, Time now);
    /// The connection ends; what is under way to the client is lost. `will`: it is published.
    void end(Client client, bool will, Time now);
    /// It restarts without its file, when nothing is connected.
    void lose_stored() { stored_.clear(); }
    /// A copy of a message that clients had before comes again to one of them, not marked as stored.
    void replay(Client to, const Message& message, Time now);

    std::optional<Time> next() const;
    void deliver_until(Time now);

    /// Told of each message that a client gets.
    std::function<void(Client to, const Message&, Time)> watch;

    /// Announcements so far, with the time at which each was published.
    const std::deque<std::pair<Time, Message>>& published() const { return published_; }

  private:
    struct Subscription {
        Client client;
        std::string filter;
        bool no_local;
    };
    struct Session {
        Receive receive;
        std::optional<Message> will;
        std::vector<std::string> filters;
        Time last{};
        std::map<std::string, Time, std::less<>> last_of_topic;
        std::map<Client, Time> last_from;
    };
    struct From {
        Client client;  // 0: none
        bool will;
    };
    struct Delivery {
        Time due;
        std::uint64_t number;
        Client client;
        std::shared_ptr<const Message> message;
        bool operator<(const Delivery& other) const {
            return due != other.due ? due > other.due : number > other.number;
        }
    };
    struct Stored {
        Message message;
        Time at;
    };

    std::optional<Message> left_of(const Stored& stored, Time now) const;
    void forget(Client client, const std::string& filter);
    std::vector<Client> receivers(const std::string& topic, Client from) const;
    void publish(From from, Message message, Time now);
    void send(Client client, Session& session, std::shared_ptr<const Message> message, From from, Time now);

    Dice& dice_;
    bool in_order_;
    Client last_client_ = 0;
    std::uint64_t number_ = 0;
    std::map<Client, Session> sessions_;
    std::unordered_map<std::string, std::vector<Subscription>> subscriptions_;  // by what has no wildcard
    std::map<std::string, Stored> stored_;
    std::priority_queue<Delivery> under_way_;
    std::deque<std::pair<Time, Message>> published_;
};

}  // namespace truth::presence
