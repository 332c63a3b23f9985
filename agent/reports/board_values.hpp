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

/// How the board stands: its properties, by its description, and their values, by what it reports and by
/// every request that it executes, of any sender. Publishes both, retained, and answers from memory: no
/// reader makes the agent send anything to the board. Pure.
class BoardValues {
  public:
    /// Between two documents of values. What changed is told at once where the last one is older.
    static constexpr Duration kBetween = std::chrono::milliseconds(100);
    /// The same where only numbers changed that the board reports by itself: they are in its reports, too.
    static constexpr Duration kBetweenNumbers = std::chrono::seconds(1);
    /// Answers a second to one demander.
    static constexpr std::size_t kMaxAnswers = 20;

    /// `board` and `age` must outlive it.
    BoardValues(const Board& board, const CommandAge& age) : board_(board), age_(age) {}

    // --- what the board does
    /// A request of anybody was queued.
    void queued(session::RequestId id, std::string_view line);
    void on_finished(const session::Finished& end, Time now);
    /// The board executed a request of our own.
    void executed(std::string_view line, Time now);
    /// A service reported, by its model.
    void reported(const std::string& service, const nlohmann::json& published, Time now);
    /// It restarted: nothing is known of it.
    void restarted(Time now);
    /// It cannot be heard: its last values stay until it is back, and then nothing is known.
    void away() { away_ = true; }
    /// It is there (again), with its settings restored.
    void identified(Time now);
    /// Requests that make the board say the levels of its inputs: the mode that such a pin has is set once
    /// more where it cannot be asked for them, and a pin that commands had made an input, and that a restart
    /// left unused, is one again. Never a
    /// pin that is or was an output.
    std::vector<std::string> lines_to_learn(const model::Labels& labels) const;
    /// Modes that commands set since the last call: pin and mode. Then the description is to say them, and
    /// modes_told() to be called.
    std::vector<std::pair<int, int>> take_modes() { return std::exchange(modes_, {}); }
    void modes_told(const std::vector<std::pair<int, int>>& modes, Time now);

    /// Time has passed: contacts are quiet again, buttons are held.
    void tick(Time now) { note(known_.tick(now), kBetween, now); }

    const property::KnownValues& known() const { return known_; }
    /// Counts what changed more than the time of a value.
    std::uint64_t changes() const { return changes_; }
    /// The properties that a request sets which is under way.
    std::vector<std::string> set_by(session::RequestId id) const;

    // --- what is told
    /// The description is this one now.
    void describe(model::Description description, Time now);
    void connected(Time now);
    /// Somebody empties what the broker keeps of this board, a topic at a time: all of it is told again a
    /// second later.
    void emptied(Time now);
    /// What is due later is due now.
    void hurry(Time now);
    /// To be called only where the bus is there, and the name ours. `session`: of the announcements.
    void publish(const std::string& session, Time now, Effects& out);
    std::optional<Time> next_deadline() const;
    /// A demander asks for the values of the services that its demand names.
    void answer(std::string_view demander, const bus::Demand& demand, const std::string& session, Time now,
                Effects& out);

  private:
    struct Quota {
        Time second{};
        std::size_t answers = 0;
    };

    /// A request by the model of its service, which must stay as long.
    struct Request {
        model::ModelPtr model;
        std::string service;
        model::RequestValues values;
    };
    std::optional<Request> read(std::string_view line) const;
    void apply(const Request& request, bool perhaps, Time now);
    void forget(Time now);
    void note(bool changed, Duration between, Time now);
    bool may_answer(std::string_view demander, Time now);

    const Board& board_;
    const CommandAge& age_;
    property::KnownValues known_;
    std::unordered_map<session::RequestId, Request> requests_;  // bounded by the session's queue
    std::vector<std::pair<int, int>> modes_;
    std::map<std::string, Quota, std::less<>> quotas_;
    std::uint64_t seq_ = 0;
    std::uint64_t restarts_ = 0;
    std::uint64_t changes_ = 0;
    bool away_ = false;
    bool list_changed_ = true;
    bool values_changed_ = true;
    std::optional<Time> due_;
    std::optional<Time> again_;
    std::optional<Time> published_at_;
};

}  // namespace asip::agent
