// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/property/documents.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/ask/bus_session.hpp"
#include "cli/environment.hpp"

namespace asip::cli {

/// The properties and values of one board, from its agent's memory and from reports meanwhile. Nothing is
/// sent to the board. `services`: a pattern.
class BoardValues {
  public:
    /// All but `board` must outlive it; it asks at once. Not moved.
    BoardValues(Environment& environment, BusSession& session, const KnownBoard& board,
                std::string services = "*");
    BoardValues(const BoardValues&) = delete;
    BoardValues& operator=(const BoardValues&) = delete;

    /// Boards without an agent of ours never do.
    bool answered() const { return answered_; }
    /// Also every value that the board reports by itself.
    bool complete() const;
    /// By the agent; where it did not answer, by the description.
    const std::vector<property::Property>& properties();
    /// By the number of the property, with its age now.
    property::ShownValue of(std::size_t property) const;
    /// The number on the wire that was set last; nothing: not known.
    std::optional<int> raw_set(std::string_view id) const;
    /// Electrical: {"digital":{"2":1},"analog":{"0":320}}.
    const nlohmann::json& pins() const { return pins_; }

  private:
    struct Known {
        property::ShownValue shown;
        Time at{};
    };
    void make_list();
    void use(std::vector<property::Property> properties);
    void answer(const mqtt::Message& message);
    void report(const mqtt::Message& message);

    Environment& environment_;
    const std::string services_;
    model::Description description_;
    std::vector<property::Property> properties_;
    std::vector<bool> will_report_;  // by the number of the property
    std::vector<Known> known_;
    nlohmann::json pins_ = nlohmann::json::object();
    bool answered_ = false;
    bool listed_ = false;  // properties_ is made
    BusSession::Subscription reports_;
    BusSession::Demand demand_;
    BusSession::Request question_;
};

/// "high" or "low", or a number of an analog channel.
std::optional<int> pin_value(const nlohmann::json& pins, const char* event, int key);

}  // namespace asip::cli
