// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/bus/topics.hpp"
#include "asip/random.hpp"
#include "registry/catalogue_types.hpp"
#include "registry/change_feed.hpp"
#include "registry/first_state.hpp"
#include "registry/history/keeper.hpp"
#include "registry/identity_watch.hpp"
#include "registry/loss_notices.hpp"
#include "registry/names_only_boards.hpp"
#include "registry/options.hpp"
#include "registry/port.hpp"
#include "registry/queries.hpp"
#include "registry/query_endpoint.hpp"
#include "registry/refusal_log.hpp"
#include "registry/statistics.hpp"
#include "registry/tidier.hpp"
#include "registry/values/value_choice.hpp"
#include "registry/values/value_keeper.hpp"

namespace asip::registry {

/// A registry without its connection: messages and time go in, messages go out through the port. It logs what
/// it decides. Time never decreases.
class Registry {
  public:
    /// `models`: those that it tells, and whose units queries may name. `history` and `values`
    /// outlive the registry; null: none is kept.
    Registry(const RegistryOptions& options, model::ModelSet models, Random random, Port port,
             HistoryKeeper* history, Instant now, ValueKeeper* values = nullptr);

    struct Subscription {
        std::string filter;
        int qos;
        bool retained;
    };
    std::vector<Subscription> subscriptions() const;
    /// The topics on which it is asked: those of the connection of Port::answer.
    std::vector<std::string> questions() const;
    mqtt::Message will() const;

    /// `max_packet_bytes`: the broker's limit; 0: none.
    void connected(std::size_t max_packet_bytes, Instant now);
    void disconnected();
    /// The connection of Port::subscribe_values is broken.
    void values_lost() {
        if (choice_) choice_->values_lost();
    }
    void message(const mqtt::Message& message, Instant now);
    /// The broker accepted, or denied, a message of QoS 1 on this topic.
    void published(const std::string& topic) { tidier_.published(topic); }
    void denied(const std::string& topic, const std::string& reason, Instant now);
    /// Call answer_in_turn() once what came meanwhile is read.
    bool questions_wait() const { return endpoint_.waits(); }
    void answer_in_turn(Instant now);
    /// What is retained is being read: no message may wait, since the last one says that all were handled.
    bool reading() const { return first_state_.active(); }
    /// Ten times a second, also while not connected.
    void tick(Instant now);
    mqtt::Message goodbye() const { return state("offline"); }

    /// Null: nobody is to be told.
    LossNotices* notices() { return notices_ ? &*notices_ : nullptr; }

    std::size_t boards() const { return catalogue_.size(); }
    /// The epoch of another registry that had this id first. Ask once connected: this one must end without a
    /// goodbye, because the topics are the other's.
    const std::optional<std::string>& id_taken_by() const { return id_taken_by_; }

  private:
    Catalogue::Options catalogue_options(const RegistryOptions& options, const model::ModelSet& models);
    Queries::Dependencies query_dependencies(model::ModelSet models);
    ValueChoice value_choice(const RegistryOptions& options);
    std::vector<std::string> board_names() const;
    void announcement(const mqtt::Message& message, const bus::TopicRef& topic);
    void refused(const mqtt::Message& message, std::string_view board, Refusal refusal);
    void identity(const mqtt::Message& message);
    void own_state(const mqtt::Message& message);
    void complete();
    void handle(const std::vector<Event>& events, bool decided_here);
    void change(const Event& event);
    void note_loss(const Event& event);
    void publish_changes();
    void publish(const bus::ChangeEvent& event);
    /// See bus::may_answer_on().
    bool may_answer(const std::string& topic);
    void publish_statistics();
    void tick_connected();
    mqtt::Message state(std::string word) const;

    bus::Topics topics_;
    std::string id_;
    std::string user_;  // of the broker, for people
    bool notifies_ = false;
    bool has_user_ = false;
    std::set<std::string> denied_;
    Random random_;
    Port port_;
    HistoryKeeper* history_;
    ValueKeeper* values_;
    Instant now_;
    std::string run_;           // random, of this start; epochs are run_ and the number of the connection
    bus::ReplyTopics replies_;  // what keeps others from them is a random level, which is published nowhere
    Catalogue catalogue_;
    ChangeFeed feed_;
    FirstState first_state_;
    RefusalLog refusals_;
    Statistics statistics_;
    IdentityWatch identity_;
    Tidier tidier_;
    NamesOnlyBoards names_only_;
    Queries queries_;
    QueryEndpoint endpoint_;
    std::optional<ValueChoice> choice_;   // where values are kept
    std::optional<LossNotices> notices_;  // once the first catalogue is complete, where they are wanted
    bool stray_answer_logged_ = false;    // on this connection
    bool connected_ = false;
    std::optional<std::string> id_taken_by_;
    Time identity_logged_{};
    std::optional<Time> state_due_;  // when to publish our state again
    Time last_tick_{};
};

}  // namespace asip::registry
