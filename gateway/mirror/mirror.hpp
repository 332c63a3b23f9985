// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/topics.hpp"
#include "asip/catalogue/catalogue.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/random.hpp"
#include "gateway/instant.hpp"
#include "gateway/mirror/standing.hpp"
#include "gateway/stream/change_log.hpp"
#include "gateway/stream/values.hpp"

namespace asip::gateway {

struct RegistryInfo {
    std::string state;  ///< as it publishes it
    std::string stats;  ///< JSON text of its `$stats`; empty: none yet
    Time seen{};
};

/// What an agent counted last.
struct BoardStats {
    std::string text;  ///< JSON
    Time seen{};
};

/// The gateway's picture of the bus: the catalogue, by the same rules as a registry's, the last values, the
/// changes. Pure.
class Mirror {
  public:
    struct Port {
        std::function<void(mqtt::Message)> publish;
        std::function<void(std::string filter, bool retained)> subscribe;
        std::function<void(const std::string& filter)> unsubscribe;
    };
    struct Options {
        std::string topic_root = "asip";
        Duration forget_after = std::chrono::hours(7 * 24);
        ValueLimits values;
        catalogue::UnitsOf units_of;
        /// For a message to ourselves behind all retained ones; the caller subscribes to it.
        std::string own_topic;
    };

    Mirror(Options options, Random random, Port port);

    /// To be subscribed to before connecting.
    std::vector<std::pair<std::string, bool>> subscriptions() const;
    void subscribed(const Instant& now);
    void disconnected(const Instant& now);
    /// Other messages are ignored.
    void message(const mqtt::Message& message, const Instant& now);
    void tick(const Instant& now);

    const std::string& epoch() const { return log_.epoch(); }
    /// The catalogue holds what the broker retains, and the bus is heard.
    bool ready() const { return complete_ && subscribed_; }
    bool complete() const { return complete_; }
    /// What the broker retains is being read.
    bool reading() const { return !mark_.empty(); }
    bool connected() const { return subscribed_; }
    Instant connected_since() const { return since_; }

    std::optional<bus::BoardItem> board(std::string_view name, const Instant& now) const;
    /// For state and services: its times may be of an earlier call. Null: not known.
    std::shared_ptr<const bus::BoardItem> known(const std::string& name, const Instant& now);
    /// `view`: the asker's; null: shows everything.
    Expected<bus::Answer> find(const bus::Query& query, const Instant& now,
                               const catalogue::View* view = nullptr);
    std::vector<std::string> board_names() const;
    std::array<std::size_t, catalogue::kStates> boards_by_state(const catalogue::View& view) const {
        return catalogue_.boards_by_state(view);
    }
    std::size_t out_of_date(const catalogue::View& view) const { return catalogue_.out_of_date(view); }
    struct Lost {
        std::map<model::StateReason, std::size_t> by_reason;
        std::size_t without_asip = 0;  ///< ports where nothing has ever answered: never there to be lost
    };
    Lost lost(const catalogue::View& view, const Instant& now);
    std::size_t size() const { return catalogue_.size(); }
    bool knows(std::string_view board) const { return catalogue_.knows(board); }

    /// As agents publish them.
    Standing& standing() { return standing_; }
    const Standing& standing() const { return standing_; }
    /// `$links`, as agents publish it.
    const std::map<std::string, std::string>& links() const { return links_; }
    /// What the board reported last, else what its agent says. Nothing: nobody says.
    std::optional<property::ShownValue> shown(const std::string& board, const property::Property& property,
                                              const Instant& now);

    Values& values() { return values_; }
    const Values& values() const { return values_; }
    ChangeLog& log() { return log_; }
    const ChangeLog& log() const { return log_; }
    /// A page of the boards that `allowed` lets pass (empty: all), each as `limit` leaves it (empty: whole).
    /// Others cost a look at their names.
    ChangeFeed::ReadPage read_page(ChangeFeed::Allowed allowed, std::function<void(bus::BoardItem&)> limit);
    const std::map<std::string, RegistryInfo>& registries() const { return registries_; }
    /// Those of agents that published some within the last 45 s.
    const std::map<std::string, BoardStats>& board_stats() const { return board_stats_; }
    std::vector<std::pair<std::string, std::size_t>> services_by_kind(const catalogue::View& view) const {
        return catalogue_.services_by_kind(view);
    }
    const bus::Topics& topics() const { return topics_; }

  private:
    void standing_message(const bus::TopicRef& topic, const mqtt::Message& message, const Instant& now);
    void standing_changed(const std::string& board, const Standing::Change& change, const Instant& now);
    void announcement(const mqtt::Message& message, const bus::TopicRef& topic, const Instant& now);
    void handle(const std::vector<catalogue::Event>& events, const Instant& now);
    void change(const catalogue::Event& event, const Instant& now);
    void registry_message(const bus::TopicRef& topic, const mqtt::Message& message, const Instant& now);
    void complete_now(const Instant& now);
    void status(const Instant& now, std::string_view broker);

    bus::Topics topics_;
    Options options_;
    Random random_;
    Port port_;
    ChangeLog log_;
    Values values_;
    Standing standing_;
    catalogue::Catalogue catalogue_;
    // Boards as they were made for a caller, until they change: that costs more than a command.
    std::map<std::string, std::shared_ptr<const bus::BoardItem>> known_;
    std::map<std::string, RegistryInfo> registries_;
    std::map<std::string, BoardStats> board_stats_;
    std::map<std::string, std::string> links_;
    std::string mark_;
    Time mark_sent_{};
    bool subscribed_ = false;
    bool complete_ = false;
    Instant since_;
};

}  // namespace asip::gateway
