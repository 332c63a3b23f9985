// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/request/agent_clock.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/reply_topics.hpp"
#include "asip/mqtt/message.hpp"
#include "gateway/instant.hpp"
#include "gateway/stream/budget.hpp"

namespace asip::gateway {

/// A command on its way and what became of it.
struct CommandRecord {
    std::string id;       ///< of the client; made up where it gave none
    std::string by;       ///< its sender
    std::string target;   ///< "uno1/servo", or "uno1" for raw lines
    std::string request;  ///< the payload without `deadline_ms`
    Instant sent;
    std::optional<bus::Reply> reply;  ///< empty: under way
    bool late = false;                ///< the answer came after the client had got a timeout
    bool renewal = false;             ///< it only keeps another command in force
    bool of_many = false;             ///< one of many that are logged together
};

/// Commands from their start until a minute after their answer. Pure: the caller publishes and gives what
/// arrives. Ids belong to a session: the same id in two sessions is two commands, and each session has a
/// reply topic, and so a queue on the agent, of its own.
class Commands {
  public:
    static constexpr Duration kKeep = std::chrono::seconds(60);
    static constexpr Duration kGrace = std::chrono::milliseconds(500);  ///< for the answer's way back
    static constexpr std::size_t kMaxRecords = 65'536;
    static constexpr std::size_t kMaxUrgent = 4096;  ///< beyond those
    static constexpr std::size_t kMaxIdBytes = 64;
    static constexpr std::size_t kMaxAnswerBytes = 64 * 1024;  ///< a longer one is left out of the reply

    struct Start {
        std::string session;  ///< letters, digits and dashes: it becomes a level of the reply topic
        std::string id;       ///< empty: made up, and no repetition is recognised
        std::string by;
        std::string target;
        std::string topic;
        std::string payload;  ///< JSON object, without `deadline_ms`
        Duration deadline = std::chrono::seconds(5);
        bool urgent = false;  ///< a stop: taken when there are too many others
        /// The answer comes below urgent(), past the answers of others: the caller has subscribed that over
        /// another connection.
        bool answer_first = false;
        bool renewal = false;  ///< only keeps another command in force
        bool of_many = false;  ///< one of many that are logged together
        std::string client{};  ///< Budget: whose it is
        Budget::Part part{};   ///< of `client`: bytes_of() while the command is remembered
    };
    /// What is kept of a command, its answer aside.
    static std::size_t bytes_of(const Start& start);
    using Done = std::function<void(const CommandRecord&)>;
    enum class Started { kPublish, kRepeated, kIdReused, kTooMany };

    /// Answers come below `replies`, in a level for each session.
    explicit Commands(bus::ReplyTopics replies) : replies_(std::move(replies)) {}

    /// Those of urgent commands.
    static bus::ReplyTopics urgent(const bus::ReplyTopics& replies) { return replies.beside("urgent"); }

    /// kPublish: `message` is to be published; `start` has its id. kRepeated: nothing is, `done` is called
    /// with the first one's answer, now or later. Else `done` is not called. What was refused is not
    /// remembered, as on the bus: the same again is a new command.
    Started start(Start& start, bool v5, const Instant& now, Done done, mqtt::Message& message);
    /// What kPublish asked for cannot be done: the queue to the broker is full.
    void not_published(const Start& start, const Instant& now);
    /// False: it answers no command of ours.
    bool take(const mqtt::Message& message, const Instant& now);
    /// Call a few times a second: deadlines pass, and what was answered a minute ago is forgotten.
    void tick(const Instant& now);
    /// This program ends: every client that waits is answered, as far as is known.
    void leave(const Instant& now);
    /// Null: not known, or longer ago than a minute.
    const CommandRecord* find(std::string_view session, std::string_view id) const;
    /// Where a command was sent to; empty: not known.
    std::string topic_of(std::string_view session, std::string_view id) const;
    /// The id by which the agent knows a command.
    static std::string bus_id(std::string_view session, std::string_view id);
    std::size_t size() const { return entries_.size(); }
    /// How many have ended in each way, and how long answers took.
    struct Counters {
        std::uint64_t ok = 0, error = 0, timeout = 0, refused = 0;
    };
    const Counters& counters() const { return counters_; }
    std::function<void(const CommandRecord&, Duration)> on_finished;  ///< may be empty
    std::function<void()> before_again;  ///< a record is about to go before its minute; may be empty

  private:
    using Due = std::multimap<Time, std::string_view>;  // -> key of an entry
    struct Entry {
        CommandRecord record;
        std::string topic, reply_topic;
        Due::iterator due;  // without an answer: the end of waiting; with one: of keeping it
        bool answered = false;
        std::vector<Done> waiting;
        Budget::Part part;
    };
    using Entries = std::map<std::string, Entry, std::less<>>;  // by "SESSION.ID"
    void finish(Entry& entry, bus::Reply reply, Time now);
    void forget(Entries::iterator entry);

    bus::ReplyTopics replies_;
    Entries entries_;
    Due due_;
    std::uint64_t made_up_ = 0;
    bus::AgentClocks clocks_;  // by reply topic without a session: of one board each
    Counters counters_;
};

/// An answer as clients get it: as on the bus, and `error` is its sentence (bus::why_of()) unless it is `ok`.
std::string text_for_clients(bus::Reply reply);
/// What an answer is in HTTP: its status.
int http_status(const bus::Reply& reply);

}  // namespace asip::gateway
