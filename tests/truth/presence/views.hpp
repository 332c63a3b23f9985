// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/catalogue/catalogue.hpp"
#include "registry/registry.hpp"
#include "tests/truth/presence/sim_broker.hpp"

namespace truth::presence {

/// One program's view of all boards, fed by the broker as that program is.
class View {
  public:
    explicit View(SimBroker& broker, std::string name) : broker_(broker), name_(std::move(name)) {}
    virtual ~View() { broker_.end(client_, false, {}); }

    const std::string& name() const { return name_; }
    SimBroker::Client client() const { return client_; }
    bool is_connected() const { return client_ != 0; }
    Time connected_at() const { return connected_at_; }
    Time started_at() const { return started_at_; }
    /// Whether it was connected for a second then, and for one after: what came at other times it may never
    /// learn.
    bool heard(Time time) const;

    void start(Time now) {
        started_at_ = now;
        connect(now);
    }
    void connect(Time now);
    void disconnect(Time now);
    /// A message, past the broker.
    void hear(const Message& message, Time now) { on_message(message, now); }
    /// A few times a second.
    virtual void tick(Time now) = 0;
    virtual bool is_complete() const = 0;
    virtual std::optional<asip::bus::BoardItem> board(const std::string& name, Time now) = 0;
    static constexpr const char* kReset = "reset";
    /// The states that it reported one by one, of one board, as "lost unplugged", and resets between them.
    virtual std::vector<std::string> changes_of(const std::string&) const { return {}; }

  protected:
    virtual void on_connected(Time now) = 0;
    virtual void on_disconnected(Time now) = 0;
    virtual void on_message(const Message& message, Time now) = 0;

    SimBroker& broker_;
    SimBroker::Client client_ = 0;

  private:
    std::string name_;
    Time connected_at_{};
    Time started_at_{};
    std::vector<std::pair<Time, Time>> connections_;  // that are over
};

asip::catalogue::Instant instant(Time now);

/// asip-registry.
class RegistryView : public View {
  public:
    /// The files that it has; null: none. They outlive it.
    struct Files {
        asip::registry::HistoryKeeper* history = nullptr;
        asip::registry::ValueKeeper* values = nullptr;
    };
    RegistryView(SimBroker& broker, Dice& dice, const asip::registry::RegistryOptions& options,
                 const Files& files, Time now);

    void tick(Time now) override;
    bool is_complete() const override { return complete_; }
    std::optional<asip::bus::BoardItem> board(const std::string& name, Time now) override;
    std::vector<std::string> changes_of(const std::string& board) const override;
    /// The answer; nothing: it comes later, and answer() has it.
    const std::optional<asip::bus::Answer>& ask(const std::string& query, Time now);
    const std::optional<asip::bus::Answer>& answer() const { return answer_; }

  protected:
    void on_connected(Time now) override;
    void on_disconnected(Time) override { registry_->disconnected(); }
    void on_message(const Message& message, Time now) override;
    virtual asip::catalogue::Instant moment(Time now) const { return instant(now); }

  private:
    void event(const Message& message);

    asip::bus::Topics topics_;
    std::string id_;
    Time now_;
    bool complete_ = false;
    std::optional<asip::registry::Registry> registry_;
    std::optional<asip::bus::Answer> answer_;
    std::map<std::string, bool> filters_;  // besides those that it always has, as its connection keeps them
    std::map<std::string, std::vector<std::string>> changes_;
};

/// asip-registry, with the answers to queries and the change events that it publishes.
std::unique_ptr<View> make_registry(SimBroker& broker, Dice& dice, const std::string& id, Time now);
/// asip-gateway.
std::unique_ptr<View> make_gateway(SimBroker& broker, Dice& dice);
/// asipctl without a registry, and the client library.
std::unique_ptr<View> make_bus_view(SimBroker& broker);
/// The same, of what the Python package and the nodes of Node-RED hear. When it ends, it adds what it got,
/// and what it said of each board after that, to `recorded`, as a history of tests/vectors/presence.json
/// each.
std::unique_ptr<View> make_recorded_view(SimBroker& broker, std::vector<std::string>& recorded);

}  // namespace truth::presence
