// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/request/reply.hpp"
#include "asip/caller/caller.hpp"
#include "gateway/instant.hpp"
#include "gateway/stream/budget.hpp"

namespace asip::gateway {

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

/// Commands of clients, sent by a Caller, until a minute after their answer. Ids belong to a session, which
/// has a reply topic, and so a queue on the agent, of its own.
class Commands {
  public:
    static constexpr Duration kKeep = std::chrono::seconds(60);
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
        std::chrono::milliseconds deadline{5'000};
        bool urgent = false;  ///< a stop: taken when there are too many others
        /// The answer comes below ReplyTopics::urgent(), over another connection.
        bool answer_first = false;
        bool renewal = false;  ///< only keeps another command in force
        bool of_many = false;  ///< one of many that are logged together
        std::string client{};  ///< Budget: whose it is
        Budget::Part part{};   ///< of `client`: bytes_of() while the command is remembered
    };
    /// What is kept of a command, its answer aside.
    static std::size_t bytes_of(const Start& start);
    using Done = std::function<void(const CommandRecord&)>;
    enum class Started { kSent, kRepeated, kIdReused, kTooMany };

    /// Answers come below the caller's topics, in a level for each session.
    explicit Commands(caller::Caller& caller) : caller_(caller) {}

    /// kSent or kRepeated: `done` is called once with the answer, for a repeated id that of the first.
    /// Otherwise it is not called, and nothing is remembered.
    Started start(Start& start, const Instant& now, Done done);
    /// Forgets what was answered a minute ago. Call a few times a second.
    void tick(Time now);
    /// Null: not known any more.
    const CommandRecord* find(std::string_view session, std::string_view id) const;
    /// Empty: not known.
    std::string topic_of(std::string_view session, std::string_view id) const;
    /// As the agent knows the command.
    static std::string bus_id(std::string_view session, std::string_view id);
    std::size_t size() const { return entries_.size(); }
    struct Counters {
        std::uint64_t ok = 0, error = 0, timeout = 0, refused = 0;
    };
    const Counters& counters() const { return counters_; }
    std::function<void(const CommandRecord&, Duration)> on_finished;  ///< may be empty
    std::function<void()> before_again;  ///< a record is about to go before its minute; may be empty

  private:
    using Kept = std::multimap<Time, std::string_view>;  // the end of keeping an entry -> its key
    struct Entry {
        CommandRecord record;
        std::string topic;
        Budget::Part part;
        std::vector<Done> waiting{};
        caller::Caller::Call call{};
        Kept::iterator kept{};  // where it has a reply
    };
    using Entries = std::map<std::string, Entry, std::less<>>;  // by "SESSION.ID"
    void finish(Entries::iterator found, bus::Reply reply);

    caller::Caller& caller_;
    Entries entries_;
    Kept kept_;
    std::uint64_t made_up_ = 0;
    Counters counters_;
};

/// As on the bus; `error` is its sentence (bus::why_of()) unless it is `ok`.
std::string text_for_clients(bus::Reply reply);
int http_status(const bus::Reply& reply);

}  // namespace asip::gateway
