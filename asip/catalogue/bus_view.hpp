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

/// All boards as the bus itself shows them, for a program that asks no registry: a Catalogue, fed with the
/// messages of the service bus that one connection delivers. Pure.
///
/// Subscribe to `ROOT/servicebus/#`, or to the topics of one board, before connecting; give it each message;
/// say when the connection was lost and made again. Times must not go back. It is complete once a message
/// that the program sent itself behind its subscriptions has come back.
class BusView {
  public:
    static constexpr std::size_t kMaxBoards = 100'000;
    /// How many topics refused() remembers.
    static constexpr std::size_t kMaxRefused = 1000;

    /// `units_of`: for queries by unit.
    explicit BusView(bus::Topics topics, UnitsOf units_of = {});

    /// Takes a message; one that is not of the service bus changes nothing. Returns the name of the board
    /// that it concerned, without a line end; empty: none.
    std::string apply(const mqtt::Message& message, Time now);
    /// The boards that were lost, or forgotten, since the last call because their lease ran out. Leases are
    /// judged by everything below, too.
    std::set<std::string> expired(Time now);
    std::optional<Time> next_expiry() const { return catalogue_.next_expiry(); }

    /// The bus cannot be heard: what was known stays, and no lease is judged.
    void disconnected() { catalogue_.suspend(); }
    void connected(Time now) { catalogue_.resume(now); }

    /// Topics whose last message could not be used, with the reason. A valid message removes its entry.
    const std::map<std::string, std::string>& refused() const { return refused_; }

    /// What `query` asks for, all pages in one, with `description` where it asks for full boards.
    std::vector<bus::BoardItem> boards(bus::Query query, Instant now);
    std::vector<bus::ServiceItem> services(bus::Query query, Instant now);
    /// One board, with its description; nothing where there is no such board.
    std::optional<bus::BoardItem> board(std::string_view name, Instant now);
    /// Null when it has none, or none that can be read. Valid until the next apply() of a message of that
    /// board.
    const model::Description* description(const std::string& name) const;
    bool knows(std::string_view name) const { return catalogue_.knows(name); }
    /// In order.
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

/// The two clocks of this program.
Instant instant_now();

}  // namespace asip::catalogue
