// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>

#include "asip/bus/shares.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/program/broker_log.hpp"
#include "asip/program/stop_signal.hpp"
#include "registry/history/keeper.hpp"
#include "registry/options.hpp"
#include "registry/registry.hpp"
#include "registry/webhook.hpp"

namespace asip::registry {

/// A registry with its connection, its clock and its history file.
class Application {
  public:
    /// Throws std::runtime_error on a service model that cannot be used.
    explicit Application(RegistryOptions options);
    ~Application();

    /// Until a signal, a refusal for good by the brokers, or another registry with this id. Returns the exit
    /// status.
    int run();

  private:
    Port port();
    HistoryKeeper::Handlers history_handlers();
    ValueKeeper::Handlers value_handlers();
    mqtt::Options mqtt_options() const;
    mqtt::Client::Handlers handlers();
    std::unique_ptr<mqtt::Client> connection_for_questions();
    std::unique_ptr<mqtt::Client> connection_for_values();
    void connect_failed(const mqtt::ConnectionFailure& failure);
    void message(const mqtt::Message& message);
    void take(const mqtt::Message& message);
    void share_turn();
    void schedule_tick();
    void schedule_turn();
    void notify();
    void stop();
    void end();

    RegistryOptions options_;
    boost::asio::io_context io_;
    boost::asio::steady_timer timer_;
    std::unique_ptr<program::StopSignal> stop_signal_;
    std::unique_ptr<HistoryKeeper> history_;
    std::unique_ptr<ValueKeeper> values_;
    bus::Topics topics_;
    bus::Shares shares_;
    bus::BoardShares boards_;
    std::unique_ptr<Registry> registry_;
    std::unique_ptr<mqtt::Client> client_;
    /// A busy broker reads a message of each connection in turn.
    std::unique_ptr<mqtt::Client> answerer_;
    /// Where values are kept. Of each message a broker tells those first that ask for its very topic: a
    /// program that shows values would wait for the processor until they are kept.
    std::unique_ptr<mqtt::Client> valuer_;
    std::unique_ptr<Webhook> webhook_;
    bool notify_fault_logged_ = false;
    bool turn_scheduled_ = false;
    bool arrived_ = false;  // since the last turn
    Time reads_until_{};
    program::BrokerLog broker_log_;
    int status_ = 0;
    bool stopping_ = false;
};

}  // namespace asip::registry
