// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "asip/model/request_values.hpp"

namespace asip::agent {

/// What the commands that the board executed have set in one service, by command and element:
/// `{"write":{"13":1},"report":100}`. What may have been changed without a proof is left out. Pure.
class SettingsOfService {
  public:
    /// Beyond, what was set longest ago is left out.
    static constexpr std::size_t kMaxBytes = 8 * 1024;

    /// `executed`: false: perhaps.
    void apply(const model::ServiceModel& model, const model::RequestValues& request, bool executed);
    void clear();
    /// Empty: nothing is known.
    std::string text() const;

  private:
    struct Setting {
        nlohmann::json value;
        std::uint64_t number = 0;  // the order in which they were set
        std::size_t bytes = 0;
    };
    using Elements = std::map<std::string, Setting, std::less<>>;

    void put(const std::string& command, const std::string& element, nlohmann::json value);
    void drop(const std::string& command, const std::string& element);
    void drop_command(const std::string& command);
    void drop_oldest();

    std::map<std::string, Elements, std::less<>> commands_;  // element "": the whole service
    std::uint64_t last_ = 0;
    std::size_t bytes_ = 0;
};

/// Publishes what was set on `BOARD/SERVICE/set`, retained: each change, at most twice a second for each
/// service, the newest last. It follows every request that a board executes, of every sender: commands, raw
/// lines, point-to-point clients, what undoes a hold, a stop. Pure.
class SetValues {
  public:
    static constexpr Duration kBetween = std::chrono::milliseconds(500);
    static constexpr std::size_t kMaxServices = 256;

    /// `board` must outlive it.
    explicit SetValues(const Board& board) : board_(board) {}

    /// A request of anybody was queued.
    void queued(session::RequestId id, std::string_view line);
    void on_finished(const session::Finished& end, Time now);
    /// The board executed a request of our own.
    void executed(std::string_view line, Time now) { apply(line, true, now); }
    /// The board restarted, or may have: nothing that was set is known to be in force.
    void forget(Time now);

    /// The broker kept this of an earlier time; put right where it is not what we say.
    void stored(std::string_view service, std::string_view payload, Time now);
    /// A broker that was started anew keeps nothing.
    void connected(Time now);
    /// What is due later is due now.
    void hurry(Time now);
    /// To be called only where the bus is there, and the name ours.
    void publish(Time now, Effects& out);
    std::optional<Time> next_deadline() const;

  private:
    struct Service {
        SettingsOfService settings{};
        std::string said{};    // what was published last
        bool changed = false;  // since then
        bool again = false;    // publish it even where it is the same
        Time not_before{};
    };

    void apply(std::string_view line, bool executed, Time now);
    /// Null: there are too many.
    Service* known_or_new(std::string_view name);
    void note(Service& service, Time now);

    const Board& board_;
    std::unordered_map<session::RequestId, std::string> requests_;  // bounded by the session's queue
    std::map<std::string, Service, std::less<>> services_;
    std::optional<Time> due_;
};

}  // namespace asip::agent
