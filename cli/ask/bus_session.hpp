// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "asip/caller/caller.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// How long to wait for a mark: access rules may forbid it.
inline constexpr std::chrono::milliseconds kMarkPatience{1000};
/// After the mark, patience with brokers that hand out retained messages later.
inline constexpr std::chrono::milliseconds kRetainedPatience{150};

/// One connection to the bus as a command uses it: it waits, in order, for what it asked for. Everything runs
/// in the caller's thread, inside run_until. SIGINT and SIGTERM end every wait, and so does the end of
/// the program that reads our output (`| head -1`). The user is told when the connection is lost, and when it
/// is back.
class BusSession {
  public:
    using OnMessage = std::function<void(const mqtt::Message&)>;
    using Subscription = caller::Caller::Subscription;
    using Request = caller::Caller::Question;
    using Call = caller::Caller::Call;
    using Hold = caller::Caller::Hold;
    using Mark = caller::Caller::Mark;
    using OnAnswer = caller::Caller::Done;

    /// `environment` must outlive it.
    explicit BusSession(const Environment& environment);
    ~BusSession();  ///< leaves, if leave() was not called, and waits until the broker has closed
    BusSession(const BusSession&) = delete;
    BusSession& operator=(const BusSession&) = delete;

    /// Calls `on_message` for what matches `filter`, as long as the handle lives. Best before connect(): then
    /// it costs no round trip. Handles may end after the session.
    Subscription subscribe(const std::string& filter, OnMessage on_message,
                           mqtt::SubscribeOptions options = {});

    /// Waits for the connection. Fails with kExitBroker and what to check; refused credentials fail at once.
    Outcome<void> connect();
    bool v5() const;
    /// The broker's limit (MQTT 5); 0: it named none.
    std::size_t max_packet_bytes() const;

    /// Sends DISCONNECT: all that was asked is answered, and nothing that was published must still arrive.
    void leave();

    void publish(const std::string& topic, const std::string& payload, int qos = 0, bool retain = false);

    /// Publishes `payload` on `topic`; `on_reply` is called for each answer to it, as long as the handle
    /// lives.
    Request ask(const std::string& topic, const std::string& payload, OnMessage on_reply, int qos = 0,
                bool plain = false);
    /// A command: `on_answer` is called once, with the agent's answer, or with one that says why there is
    /// none. Unless it lasts, `--timeout` is its deadline; the user is its sender.
    Call command(caller::Command command, OnAnswer on_answer);
    /// A command that is renewed until the handle ends: caller::Caller::hold().
    Hold hold(caller::Command command, std::chrono::milliseconds hold, OnAnswer begun, OnAnswer ended);
    /// Called with all that watched boards say, and with null where a lease is over.
    void on_board(std::function<void(const std::string& board, const mqtt::Message* said)> handler);
    /// What a caller of the bus knows, and the boards that are watched.
    caller::Caller& caller() const;
    catalogue::BusView& boards() const { return caller().boards(); }

    /// For boards that report on demand: `hz` values a second are enough, as long as the handle lives, which
    /// may end after the session. `board` and `service` may be patterns; an empty service is all of them.
    /// Which boards do is in their descriptions: subscribe to those, too, or use demand().
    [[nodiscard]] bus::Demander::Want want(const std::string& board, const std::string& service,
                                           double hz = bus::kUsualHz);
    /// The same with that subscription.
    struct [[nodiscard]] Demand {
        Subscription descriptions;
        bus::Demander::Want want;
    };
    Demand demand(const std::string& board, const std::string& service, double hz = bus::kUsualHz);

    Mark mark_retained();

    /// Handles events until what the broker had retained for the subscriptions made until now has come, or
    /// `enough` holds. Access rules may forbid the mark, and some brokers hand out retained messages behind
    /// it: it ends when nothing retained has come for `patience` (from the mark on: for kRetainedPatience).
    /// How much there is, and how slow this machine is, does not matter.
    void wait_retained(
        const std::function<bool()>& enough = [] { return false; }, Duration patience = kMarkPatience);

    /// Handles events until `done` holds; false: `deadline` came, or stopped().
    bool run_until(const std::function<bool()>& done, Time deadline);
    bool run_for(Duration duration) {
        return run_until([] { return false; }, Clock::now() + duration);
    }
    /// The same for what is to be brought to its end after stopped(), too; nothing ends it early.
    bool run_to_end(const std::function<bool()>& done, Duration patience);
    /// How many QoS 1 messages of ours the broker has acknowledged.
    std::size_t acknowledged() const;
    /// Whether the user asked to end (Ctrl-C), or the reader of the output has ended.
    bool stopped() const;

    /// From now on the user is told at once of each subscription that the broker refuses: for a command
    /// that listens for long.
    void tell_refused_subscriptions();
    /// Called instead of telling the user when an established connection is lost or back.
    void on_connection_change(std::function<void(bool connected, const std::string& why)> handler);
    /// Whether an established connection was lost, and is not back.
    bool lost() const;
    /// Fails where that is so, or the user asked to end: what was heard until now is not all.
    Outcome<void> heard_all() const;
    /// What to say of a wait that was in vain: kExitNoAnswer and `text`; while the connection is lost, or the
    /// broker stands still, kExitBroker and why.
    Failure unanswered(std::string text) const;
    /// Whether the broker's access rules denied a QoS 1 message of ours on `topic`. The user has been told,
    /// or gets it as the answer to a command.
    bool denied(const std::string& topic) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::cli
