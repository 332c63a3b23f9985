// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "asip/caller/caller.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// Access rules may forbid the mark.
inline constexpr std::chrono::milliseconds kMarkPatience{1000};
/// Some brokers hand out retained messages behind the mark.
inline constexpr std::chrono::milliseconds kRetainedPatience{150};

/// One connection as a command uses it: it waits, in order, inside run_until, in the caller's thread. SIGINT,
/// SIGTERM and the end of our output's reader (`| head -1`) end every wait. The user is told when the
/// connection is lost and back.
class BusSession {
  public:
    using OnMessage = std::function<void(const mqtt::Message&)>;
    using Subscription = caller::Caller::Subscription;
    using Request = caller::Caller::Question;
    using Call = caller::Caller::Call;
    using Hold = caller::Caller::Hold;
    using Mark = caller::Caller::Mark;
    using OnAnswer = caller::Caller::Done;

    explicit BusSession(const Environment& environment);
    ~BusSession();  ///< leaves, if leave() was not called, and waits until the broker has closed
    BusSession(const BusSession&) = delete;
    BusSession& operator=(const BusSession&) = delete;

    /// As long as the handle lives, which may be longer than the session. Before connect() it costs no round
    /// trip.
    Subscription subscribe(const std::string& filter, OnMessage on_message,
                           mqtt::SubscribeOptions options = {});

    /// Fails with kExitBroker and what to check; refused credentials fail at once.
    Outcome<void> connect();
    bool v5() const;
    /// The broker's limit (MQTT 5); 0: none.
    std::size_t max_packet_bytes() const;

    /// Sends DISCONNECT: nothing that was published must still arrive.
    void leave();

    void publish(const std::string& topic, const std::string& payload, int qos = 0, bool retain = false);

    /// `on_reply` is called for each answer, as long as the handle lives.
    Request ask(const std::string& topic, const std::string& payload, OnMessage on_reply, int qos = 0,
                bool plain = false);
    /// `on_answer` is called once, with the agent's answer or with why there is none. Unless the command
    /// lasts, `--timeout` is its deadline; the user is its sender.
    Call command(caller::Command command, OnAnswer on_answer);
    /// See caller::Caller::hold().
    Hold hold(caller::Command command, std::chrono::milliseconds hold, OnAnswer begun, OnAnswer ended);
    /// All that watched boards say; null: a lease is over.
    void on_board(std::function<void(const std::string& board, const mqtt::Message* said)> handler);
    caller::Caller& caller() const;
    catalogue::BusView& boards() const { return caller().boards(); }

    /// For boards that report on demand: `hz` values a second, as long as the handle lives. `board` and
    /// `service` may be patterns; an empty service is all. Needs their descriptions: subscribe, or use
    /// demand().
    [[nodiscard]] bus::Demander::Want want(const std::string& board, const std::string& service,
                                           double hz = bus::kUsualHz);
    /// With that subscription.
    struct [[nodiscard]] Demand {
        Subscription descriptions;
        bus::Demander::Want want;
    };
    Demand demand(const std::string& board, const std::string& service, double hz = bus::kUsualHz);

    Mark mark_retained();

    /// Waits until what the broker had retained for the subscriptions until now has come, or `enough` holds.
    /// Where access rules forbid the mark it ends after `patience` without a retained message, from the mark
    /// on after kRetainedPatience.
    void wait_retained(
        const std::function<bool()>& enough = [] { return false; }, Duration patience = kMarkPatience);

    /// False: `deadline` came, or stopped().
    bool run_until(const std::function<bool()>& done, Time deadline);
    bool run_for(Duration duration) {
        return run_until([] { return false; }, Clock::now() + duration);
    }
    /// Goes on after stopped().
    bool run_to_end(const std::function<bool()>& done, Duration patience);
    /// QoS 1 messages of ours.
    std::size_t acknowledged() const;
    /// By Ctrl-C, or the output's reader has ended.
    bool stopped() const;

    /// For a command that listens for long.
    void tell_refused_subscriptions();
    /// In place of telling the user.
    void on_connection_change(std::function<void(bool connected, const std::string& why)> handler);
    /// Established before, and not back.
    bool lost() const;
    /// Fails where lost() or stopped(): more may be to hear.
    Outcome<void> heard_all() const;
    /// After a wait in vain: kExitNoAnswer and `text`; without a working connection kExitBroker and why.
    Failure unanswered(std::string text) const;
    /// The broker denied a QoS 1 message of ours. The user has been told, or gets it as an answer.
    bool denied(const std::string& topic) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace asip::cli
