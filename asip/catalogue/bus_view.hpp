// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/bus/topics.hpp"
#include "asip/catalogue/catalogue.hpp"
#include "asip/model/description.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"

namespace asip::catalogue {

/// All boards as the bus shows them, without a registry: a Catalogue fed with the messages of one connection.
/// Pure.
/// Subscribe to `ROOT/servicebus/#`, or to the topics of one board, before connecting. It is complete once a
/// message that the program sent itself behind its subscriptions has come back. Times must not go back.
class BusView {
  public:
    static constexpr std::size_t kMaxBoards = 100'000;
    /// How many topics refused() remembers.
    static constexpr std::size_t kMaxRefused = 1000;

    explicit BusView(bus::Topics topics, UnitsOf units_of = {});

    /// Returns the name of the board that the message concerned, without a line end; empty: none.
    std::string apply(const mqtt::Message& message, Time now);
    /// The boards that were lost or forgotten since the last call because their lease ran out. Every other
    /// call judges leases, too.
    std::set<std::string> expired(Time now);
    std::optional<Time> next_expiry() const { return catalogue_.next_expiry(); }

    /// The bus cannot be heard: no lease is judged.
    void disconnected() { catalogue_.suspend(); }
    void connected(Time now) { catalogue_.resume(now); }

    /// The reason for each topic whose last message could not be used.
    const std::map<std::string, std::string>& refused() const { return refused_; }

    /// All pages of the answer to `query`, with `description` where it asks for full boards.
    std::vector<bus::BoardItem> boards(bus::Query query, Instant now);
    std::vector<bus::ServiceItem> services(bus::Query query, Instant now);
    /// With its description; nothing: there is no such board.
    std::optional<bus::BoardItem> board(std::string_view name, Instant now);
    /// Null: it has none that can be read. Valid until the next message of that board.
    const model::Description* description(const std::string& name) const;
    bool knows(std::string_view name) const { return catalogue_.knows(name); }
    std::vector<std::string> names() const;

  private:
    void judge_leases(Time now);
    void judge(const mqtt::Message& message, const std::string& board, std::optional<Refusal> refusal);

    bus::Topics topics_;
    Catalogue catalogue_;
    std::map<std::string, std::string> refused_;
    std::set<std::string> expired_;
    mutable std::map<std::string, std::optional<model::Description>> descriptions_;  // those that were asked
                                                                                     // for
};

Instant instant_now();

}  // namespace asip::catalogue
