// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "asip/bus/request/demander.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/bus/request/requester.hpp"
#include "asip/bus/topics.hpp"
#include "asip/catalogue/bus_view.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/router.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::caller {

/// A command to a board, or a request to its agent.
struct Command {
    std::string topic;
    std::string payload;                        ///< a request line, or a JSON object
    std::chrono::milliseconds deadline{5'000};  ///< within it the agent answers
    int qos = 1;
    bool plain = false;  ///< for a board that takes part by names only: it reads lines, and no JSON
    bool lasts = false;  ///< the broker may deliver it behind its deadline, which the agent is not told
    bool first = false;  ///< ahead of all that waits for the broker: Port::publish_first
    /// Its agent's answer behind one that was made here is told, too, as long as the handle lives.
    bool late = false;
    std::string by{};  ///< the user, for histories; empty: not said
    /// Said where nothing answers: "no answer to S,W,0,90 within 300 ms".
    std::string silence{};
    std::string id{};  ///< of no other command that waits; empty: made here
    /// Where its answer comes, which the program has subscribed to; none: where the caller's answers do.
    std::optional<bus::ReplyTopics> replies{};
};

/// What is known of the connection and of the access rules of its broker, from how messages ended: brokers of
/// MQTT 5 say that they deny a message of QoS 1, others say nothing, or close the connection behind it.
class Access {
  public:
    Access(std::string user, std::string role) : user_(std::move(user)), role_(std::move(role)) {}

    /// A message was published.
    void sent(const std::string& topic) { last_topic_ = topic; }
    /// One that wants an answer. `silent`: a broker that denies it does not say so.
    void asked(const std::string& topic, bool silent);
    void connected() { why_lost_.reset(); }
    void disconnected(const mqtt::ConnectionFailure& why);

    /// There was a connection, and there is none: why.
    const std::optional<std::string>& why_lost() const { return why_lost_; }
    /// The connection ends again and again right behind messages of ours.
    bool denies() const { return denies_; }
    /// Topic of the last message; empty: none.
    const std::string& last_topic() const { return last_topic_; }

    /// "the broker does not let ann write to ...".
    std::string denied_text(const std::string& topic, const std::string& reason) const;
    /// Behind a sentence that nothing answered: what the access rules may have to do with it. Empty: nothing.
    std::string may_be_denied() const;

  private:
    /// As what `asipctl secure` is to add the user.
    std::string role_for(const std::string& topic) const;

    std::string user_, role_;
    std::string last_topic_;
    std::optional<std::string> denied_in_silence_;  // the last question may have been
    std::optional<std::string> cut_off_by_;         // right behind a message on this topic it was closed
    std::optional<std::string> why_lost_;
    bool denies_ = false;
};

/// A program that calls boards and registries over the bus: its calls and their answers, the commands that it
/// holds, the values that it demands, the boards that it looks at. Calls, messages and time go in; what is to
/// be published, subscribed or told goes out through a Port. Pure: no socket, no clock, one thread.
///
/// Every command ends with exactly one answer. Those that no agent gave are made here, in the words of
/// bus::sentence_of(): `denied`, `queue-full`, `no-answer` and `connection`.
class Caller {
  public:
    /// The answer of an agent finds its way in this time behind a deadline.
    static constexpr std::chrono::milliseconds kAnswerTime{500};
    /// Every broker that lives has acknowledged a message by then.
    static constexpr std::chrono::seconds kTimeToAcknowledge{1};

    struct Options {
        bus::Topics topics;
        std::string user;               ///< of the broker; may be empty
        std::string name;               ///< one level of a topic, of no other program
        catalogue::UnitsOf units_of{};  ///< for queries by unit
        int qos = 1;                    ///< at which answers, and what boards say of themselves, are to come
        /// As what `asipctl secure` adds the user; empty: as one who asks what was asked.
        std::string role{};
    };

    /// How the caller acts on the world. Nothing here calls back into it.
    struct Port {
        /// False: there is no room for it.
        std::function<bool(mqtt::Message)> publish;
        std::function<bool(mqtt::Message)> publish_first{};  ///< of commands that are `first`
        std::function<void(const std::string& filter, mqtt::SubscribeOptions)> subscribe;
        std::function<void(const std::string& filter)> unsubscribe;
        std::function<bool()> v5;  ///< the connection speaks MQTT 5
        /// Messages of QoS 1 that the broker has not confirmed. May be empty.
        std::function<std::size_t()> unacknowledged;
        /// Tells what a watched board said, or (null) that its lease is over. May be empty; it may call the
        /// caller.
        std::function<void(const std::string& board, const mqtt::Message* said)> changed{};
    };

    /// Subscribes to its answers; nothing is published before connected().
    Caller(Options options, const Random& random, Port port);
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;

    // What happens. Times never go back.
    void connected(Time now);
    void disconnected(const mqtt::ConnectionFailure& why, Time now);
    /// True: it was an answer.
    bool message(const mqtt::Message& message, Time now);
    /// The broker's access rules refused a message of QoS 1. True: that ended a command, whose answer says
    /// it.
    bool denied(const std::string& topic, const std::string& reason);
    /// To be called at the latest when next_deadline() has come.
    void tick(Time now);
    std::optional<Time> next_deadline() const;
    /// The program ends: no board is to report for it any more. Commands that wait are not told.
    /// True: something was published.
    bool leave();

    /// Publishes what needs no answer; false: there is no room for it.
    bool publish(mqtt::Message message);

    using Done = std::function<void(const bus::Reply&)>;
    /// The interest in one answer; when it ends, nothing is told any more. May outlive the caller.
    class [[nodiscard]] Call {
      public:
        Call() = default;
        void reset() { entry_.reset(); }
        /// By which an agent knows the command; empty: it was answered.
        const std::string& id() const;

      private:
        friend class Caller;
        struct Entry;
        explicit Call(std::shared_ptr<Entry> entry) : entry_(std::move(entry)) {}
        std::shared_ptr<Entry> entry_;
    };
    /// `done` is called once (Command::late: or twice), never from inside this: with the agent's answer, or
    /// with one that is made here. A command is sent once for each connection that breaks before the broker
    /// confirms it; agents execute it once.
    Call command(Command command, Done done, Time now);
    /// When what happened last happened.
    Time now() const { return now_; }
    /// Ends all commands that wait, with this answer.
    void end_all(const bus::Reply& reply);
    /// Topic of the oldest command that waits; empty: none.
    std::string waiting_topic() const;

    /// A command that its agent undoes unless it is renewed, by its id and by the agent's clock, three times
    /// within `hold`. The command ends, and is undone, when the handle does: then nothing renews it.
    class [[nodiscard]] Hold {
      public:
        Hold() = default;
        void reset() { entry_.reset(); }

      private:
        friend class Caller;
        struct Entry;
        explicit Hold(std::shared_ptr<Entry> entry) : entry_(std::move(entry)) {}
        std::shared_ptr<Entry> entry_;
    };
    /// `begun` gets the answer to the command; where that is `ok`, `ended` gets the agent's word that it is
    /// not held any more, if it comes.
    Hold hold(Command command, std::chrono::milliseconds hold, Done begun, Done ended, Time now);

    /// Publishes a question that any number of programs may answer; `on_answer` is called for each, as long
    /// as the handle lives, which is empty where there was no room for the question. There is no time limit.
    using Question = bus::Requester::Request;
    Question ask(mqtt::Message question, mqtt::Router::OnMessage on_answer, Time now, bool plain = false);

    using Subscription = mqtt::Router::Subscription;
    /// Calls `on_message` for what matches `filter`, as long as the handle lives, which may outlive the
    /// caller.
    Subscription subscribe(const std::string& filter, mqtt::Router::OnMessage on_message,
                           mqtt::SubscribeOptions options = {});

    /// Values that are wanted of boards that report on demand, as long as the handle lives. Which boards do
    /// is in their descriptions, which must be watched or subscribed to.
    [[nodiscard]] bus::Demander::Want want(const std::string& board, const std::string& service,
                                           double hz = bus::kUsualHz) {
        return demander_.want(board, service, hz);
    }

    /// Takes notice of one board, and of all, from now on: what they say of themselves makes `boards()`.
    void watch(const std::string& board);
    void watch_names(const std::string& board);
    void watch_description(const std::string& board);  ///< "+": of all
    void watch_all();
    catalogue::BusView& boards() { return view_; }
    const catalogue::BusView& boards() const { return view_; }
    /// What is stored of a board comes in any order: whether its state has come over this connection, or it
    /// has spoken itself.
    bool heard_of(const std::string& board) const { return told_.contains(board); }

    /// Passed once what the broker had retained for the subscriptions made before it has arrived (on brokers
    /// that answer in order; others need some patience after it).
    class Mark {
      public:
        bool passed() const { return passed_at().has_value(); }
        std::optional<Time> passed_at() const { return at_ ? *at_ : std::nullopt; }

      private:
        friend class Caller;
        std::shared_ptr<std::optional<Time>> at_;
        Subscription subscription_;
    };
    Mark mark_retained();
    /// When something retained came last.
    Time retained_at() const { return retained_at_; }

    const bus::Topics& topics() const { return options_.topics; }
    const bus::ReplyTopics& replies() const { return requester_.replies(); }
    const Access& access() const { return access_; }
    /// How a wait of `waited` ended in vain: `connection`, or `no-answer` and `text` with what is known of
    /// the access rules.
    bus::Reply silence(std::string text, Duration waited) const;

  private:
    using Due = std::multimap<Time, std::weak_ptr<Call::Entry>>;
    void finish(const std::shared_ptr<Call::Entry>& call, const bus::Reply& reply, bool last = true);
    void finish_due(Time now);
    void begin_hold(const std::shared_ptr<Hold::Entry>& hold, const bus::Reply& reply);
    void renew(const std::shared_ptr<Hold::Entry>& hold, Time now);
    bool publish_asked(mqtt::Message message, bool first = false);
    void publish_demands(Time now);
    void look_at(const mqtt::Message& message, Time now);
    void look_at_leases(Time now);
    void listen(const std::string& filter);

    Options options_;
    Port port_;
    bus::Requester requester_;
    bus::Demander demander_;
    catalogue::BusView view_;
    mqtt::Router router_;
    Access access_;
    Due due_;
    std::list<std::weak_ptr<Hold::Entry>> holds_;
    std::set<std::string> listened_, told_;  // filters; boards
    std::string watched_;                    // the prefix of what is said of boards
    std::optional<Time> lease_over_;         // the first of them
    std::size_t marks_ = 0;
    Time now_{};
    Time retained_at_{};
};

/// A caller acts through this connection, which must outlive what the caller does; `changed` is left empty.
Caller::Port port_of(mqtt::Client& client);

}  // namespace asip::caller
