// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "agent/inbound/command_age.hpp"
#include "asip/bus/request/demand.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/property/known_values.hpp"

namespace asip::agent {

/// How the board stands: its properties, by its description, and their values, by its reports and by each
/// request that it executes. Publishes both, retained, and answers from memory: no reader makes the agent
/// send anything to the board. Pure.
class BoardValues {
  public:
    /// Between two documents of values.
    static constexpr Duration kBetween = std::chrono::milliseconds(100);
    /// The document follows a report or answer by this time, so that broker and readers handle that first.
    /// Boards with contacts do not wait: links read the document.
    static constexpr Duration kBehind = std::chrono::microseconds(900);
    /// The same where only numbers changed that the board's reports hold, too.
    static constexpr Duration kBetweenNumbers = std::chrono::seconds(1);
    /// A second, to one demander.
    static constexpr std::size_t kMaxAnswers = 20;

    BoardValues(const Board& board, const CommandAge& age) : board_(board), age_(age) {}

    // --- what the board does
    /// To be called for each request that is queued.
    void queued(session::RequestId id, std::string_view line);
    /// A request by its service's model, which must outlive it.
    struct Request {
        model::ModelPtr model;
        std::string service;
        model::RequestValues values;
    };
    /// What the board executed, or perhaps did.
    std::optional<Request> on_finished(const session::Finished& end, Time now);
    /// The properties that it sets.
    std::vector<std::string> set_by(const Request& request) const;
    /// The board executed a request of our own.
    void executed(std::string_view line, Time now);
    /// `published`: what a service reported, by its model.
    void reported(const std::string& service, const nlohmann::json& published, Time now);
    /// Nothing is known of the board.
    void restarted(Time now);
    /// The last values stay until the board is back; then nothing is known.
    void away() { away_ = true; }
    /// The board is there (again), its settings restored.
    void identified(Time now);
    /// Requests that make the board say its input levels: modes of such pins are set once more where the
    /// board cannot be asked, and inputs that a restart left unused become inputs again. Never a pin that is
    /// or was an output.
    std::vector<std::string> lines_to_learn(const model::Labels& labels) const;
    /// Pins and modes that commands set since the last call. The description is to say them; then call
    /// modes_told().
    std::vector<std::pair<int, int>> take_modes() { return std::exchange(modes_, {}); }
    void modes_told(const std::vector<std::pair<int, int>>& modes, Time now);

    /// Contacts are quiet again, buttons are held.
    void tick(Time now) { note(known_.tick(now), kBetween, now); }

    const property::KnownValues& known() const { return known_; }
    /// Counts changes of more than a value's time.
    std::uint64_t changes() const { return changes_; }
    /// Whether the request sets a pin low that is on while it is low.
    bool low_is_on(std::string_view line) const;
    /// What others do with a door or a button waits for the document.
    bool has_contacts() const { return has_contacts_; }

    // --- what is told
    void describe(model::Description description, Time now);
    void connected(Time now);
    /// The broker was made to forget a topic of this board: all is told again a second later.
    void emptied(Time now);
    void hurry(Time now);
    /// Only while the bus is there and the name ours. `session`: of the announcements.
    void publish(const std::string& session, Time now, Effects& out);
    std::optional<Time> next_deadline() const;
    /// Answers a demander with the values of the services that its demand names.
    void answer(std::string_view demander, const bus::Demand& demand, const std::string& session, Time now,
                Effects& out);

  private:
    struct Quota {
        Time second{};
        std::size_t answers = 0;
    };

    std::optional<Request> read(std::string_view line) const;
    void apply(const Request& request, bool perhaps, Time now);
    void forget(Time now);
    void note(bool changed, Duration between, Time now);
    bool may_answer(std::string_view demander, Time now);

    const Board& board_;
    const CommandAge& age_;
    property::KnownValues known_;
    std::unordered_map<session::RequestId, std::string> requests_;  // lines; bounded by the session's queue
    std::vector<std::pair<int, int>> modes_;
    std::map<std::string, Quota, std::less<>> quotas_;
    std::uint64_t seq_ = 0;
    std::uint64_t restarts_ = 0;
    std::uint64_t changes_ = 0;
    bool away_ = false;
    bool has_contacts_ = false;
    bool list_changed_ = true;
    bool values_changed_ = true;
    std::optional<Time> due_;
    std::optional<Time> again_;
    std::optional<Time> published_at_;
};

}  // namespace asip::agent
