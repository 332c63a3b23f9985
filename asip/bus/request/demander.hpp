// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/bus/request/demand.hpp"
#include "asip/bus/topics.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::bus {

/// Demands values of boards that report on demand, for all parts of a program: tells each what is wanted,
/// again at a third of the lease and when it announces itself, and once when nothing is. Pure: the caller
/// subscribes to the descriptions of its boards, passes them to description() or take(), and publishes what
/// due() returns, at next_deadline() at the latest.
class Demander {
  public:
    static constexpr std::size_t kMaxBoards = 100'000;

    /// `user`: may be empty. `client`: one level of a topic that no other program has.
    Demander(const Topics& topics, std::string_view user, std::string_view client, Random random);

    /// Holds until its last copy is gone; may outlive the demander.
    using Want = std::shared_ptr<void>;
    /// `hz` values a second, kept within 0.001 and 1000. Names may be patterns; one that no service can have
    /// is passed over.
    [[nodiscard]] Want want(const std::string& board, const std::string& service, double hz = kUsualHz);

    void description(const std::string& board, bool on_demand, Time now);
    /// Messages that are no description are passed over.
    void take(const mqtt::Message& message, Time now);

    void connected(Time now);
    void disconnected() { connected_ = false; }

    std::vector<mqtt::Message> due(Time now);
    /// None: not before something else happens.
    std::optional<Time> next_deadline() const;
    /// For a program that ends: nothing is wanted any more.
    std::vector<mqtt::Message> leave();

  private:
    using Rates = std::multiset<double>;
    using Services = std::map<std::string, Rates>;
    struct Wants {
        std::map<std::string, Services, std::less<>> boards;
        std::map<std::string, Services> patterns;  // of boards
        std::set<std::string> changed;             // of both
    };
    struct Board {
        bool told = false;  // it counts on us
        std::optional<Time> told_at;
        std::optional<Time> next;
    };
    static Services& services_of(Wants& wants, const std::string& board);
    static void end(Wants& wants, const std::string& board, const std::string& service, double hz);

    void look_at_changes();
    void schedule(const std::string& name, Board& board, Time when);
    std::map<std::string, double> wanted_of(const std::string& board) const;
    mqtt::Message message(const std::string& board, std::map<std::string, double> services) const;
    Time renewal(Time now) const;

    Topics topics_;
    std::string demander_;
    Random random_;
    std::shared_ptr<Wants> wants_ = std::make_shared<Wants>();
    std::map<std::string, Board> boards_;  // those on demand
    std::set<std::pair<Time, std::string>> schedule_;
    bool connected_ = false;
};

}  // namespace asip::bus
