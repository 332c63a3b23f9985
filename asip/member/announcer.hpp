// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/description.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/mqtt/subscriptions.hpp"
#include "asip/program/log.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::member {

struct Publication {
    mqtt::Message message;
    mqtt::Priority priority = mqtt::Priority::kContext;
};
using Publications = std::vector<Publication>;

/// For the log.
struct Notice {
    program::log::Level level = program::log::Level::kInfo;
    std::string text;
    std::vector<std::pair<std::string, std::string>> fields;
};

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

/// An empty payload clears the topic.
mqtt::Message retained(std::string topic, std::string payload = {});

/// Takes out the answers (Priority::kReply and kUrgent) that bus::may_answer_on() denies; returns their
/// topics.
std::vector<std::string> take_stray_answers(Publications& publish, const bus::Topics& topics,
                                            std::string_view board);

struct AnnouncerOptions {
    std::string board;
    int lease_seconds = model::kDefaultLeaseSeconds;
    bool takeover = false;
    /// Since 1970: of two agents with one name all agree on the later session.
    std::uint64_t started_unix = 0;
    /// Publish the board's name on the shared topic, too. Access rules cannot tie that one to its sender: a
    /// secured bus denies it.
    bool on_shared_topic = true;
    /// While a board with a stored name is away, another agent that has it may claim its name.
    bool name_of_board = false;
};

/// Claims a board's name, announces the board, keeps its lease, answers probes, and puts its `$state` right
/// when another sender (a late will) wrote it.
/// A claim probes for a living holder, and waits 1.3 s. Once established, an older session is a ghost; a
/// later one has taken the name over if its agent answers a probe; a single message without a living agent,
/// or a goodbye, is put right.
/// The description holds the board's state, reason and time, and is announced ahead of `$state`, so that
/// readers learn all at once.
/// Nothing is announced before commands can come. The description alone, with QoS 0, renews the lease, which
/// outlives a lost one; names are published on changes and probes. Where what is retained does not expire,
/// the broker is told to retain the same only once a lease.
class Announcer {
  public:
    Announcer(const bus::Topics& topics, AnnouncerOptions options, Random random);

    /// `board`, `session`, `seq` and `lease` are filled in. Announced within a second where established.
    void describe(model::Description description);
    /// From `now` on. Announced at once where established.
    void set_state(model::BoardState state, model::StateReason reason, Time now, Announcements& out);
    model::BoardState state() const { return state_; }
    /// JSON for "updating": who has the board's port, and until when; empty: nobody. Announced as describe()
    /// is.
    void set_updating(std::string json);

    void leave_shared_topic() { options_.on_shared_topic = false; }

    /// Beside commands, before connecting.
    struct Subscription {
        std::string filter;
        mqtt::SubscribeOptions options;
    };
    static std::vector<Subscription> subscriptions(const bus::Topics& topics, const std::string& board);
    std::vector<Subscription> subscriptions() const { return subscriptions(topics_, options_.board); }

    /// `expires`: what this broker retains; else each renewal need not be retained.
    void on_connected(Time now, Announcements& out, bool expires = true);
    void on_disconnected();
    /// Commands reach us now.
    void on_subscribed(Time now, Announcements& out);
    /// On our board's service-bus topics, or on the probe topic.
    void on_message(const mqtt::Message& message, Time now, Announcements& out);
    void tick(Time now, Announcements& out);
    std::optional<Time> next_deadline() const;

    /// The board is offline, because its agent was stopped.
    void goodbye(Time now, Announcements& out);

    bool established() const { return established_; }
    /// With the bus.
    bool may_publish() const { return established_ && connected_; }
    /// Its description is ahead of what is published now: readers take what is of the session that it says.
    bool is_announced() const { return may_publish() && subscribed_; }
    const std::string& session() const { return session_; }
    mqtt::Message will() const;

  private:
    /// A later session that has to show a living agent.
    struct Challenge {
        std::string session;
        std::uint64_t seq = 0;
        std::string holder;
        Time ends;
    };

    void challenge(const model::Description& other, bool lives, const std::string& holder, Time now,
                   Announcements& out);
    /// State, description and names.
    void announce(Time now, Announcements& out);
    /// False as publish_description().
    bool announce_board(Time now, Announcements& out);
    void publish_names(Announcements& out);
    /// Renews the lease. False: there is none yet, or it may not be sent.
    bool publish_description(int qos, bool retain, Time now, Announcements& out);
    /// The broker is due to retain the same again. While it is open whether a later session lives, what the
    /// broker has of that one stays: programs that start see what those see that were there.
    bool retains(Time now) const {
        return !challenge_ && (expires_ || !retained_until_ || now >= *retained_until_);
    }
    std::string description_text() const;
    void publish_state(bool retain, Announcements& out);
    void on_foreign_description(const mqtt::Message& message, Time now, Announcements& out);
    void schedule_renewal(Time now);
    void announce_within(Duration limit, Time now);

    bus::Topics topics_;
    AnnouncerOptions options_;
    Random random_;
    std::string session_;
    std::uint64_t seq_ = 0;
    model::Description description_;
    std::string updating_;
    model::BoardState state_ = model::BoardState::kLost;
    model::StateReason reason_ = model::StateReason::kSilent;
    Time state_since_{};  // Time{}: since it was first announced
    bool described_ = false;
    bool connected_ = false;
    bool expires_ = true;
    bool subscribed_ = false;
    bool state_said_ = false;   // over this connection: what is retained behind that is not older
    bool established_ = false;  // the name is ours
    std::optional<Challenge> challenge_;
    Time last_announced_{};
    /// This connection's broker has the present description until then.
    std::optional<Time> retained_until_;
    std::optional<Time> claim_ends_;
    std::optional<Time> renewal_;
    std::optional<Time> probe_answer_;
    std::optional<Time> names_;  // are published
};

}  // namespace asip::member
