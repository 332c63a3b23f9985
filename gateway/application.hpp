// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "asip/bus/shares.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/program/broker_log.hpp"
#include "asip/program/stop_signal.hpp"
#include "gateway/gateway.hpp"
#include "gateway/http/server.hpp"
#include "gateway/options.hpp"
#include "gateway/running_exports.hpp"

namespace asip::gateway {

/// A gateway with its server, its connections to the bus and its clock, on one thread. It does the logging.
class Application {
  public:
    /// Throws std::runtime_error where an address, a certificate, the tokens or a model cannot be used.
    explicit Application(ProgramOptions options);
    ~Application();

    /// Until a signal, or a refusal for good by the brokers. Returns the exit status.
    int run();

  private:
    Gateway::Port port();
    void turn();
    template <class Handle>
    void then_run(Handle handle);
    mqtt::Client::Handlers handlers();
    std::vector<ExportStanding> exports_stand() const;
    void add_refusals(mqtt::Client::Handlers& to) const;
    std::unique_ptr<mqtt::Client> connection_for_answers(const mqtt::Options& like, const char* name,
                                                         mqtt::Client::Handlers handlers);
    void connect_failed(const mqtt::ConnectionFailure& failure);
    void schedule_tick();
    void read_tokens(bool first);
    void log_access() const;
    void message(const mqtt::Message& received);
    void handle(const mqtt::Message& received);
    void stop();
    void end();

    ProgramOptions options_;
    boost::asio::io_context io_{1};
    boost::asio::steady_timer timer_;
    boost::asio::steady_timer soon_;
    std::unique_ptr<program::StopSignal> stop_signal_;
    std::unique_ptr<mqtt::Client> client_;
    // A broker delivers the messages of one connection one behind the other: answers must not wait behind
    // what boards publish, nor those to stops behind any.
    std::unique_ptr<mqtt::Client> asker_, stopper_;
    bus::Shares shares_;
    bool handles_ = false, waits_ = false;  // a message; jobs that came with it
    bus::BoardShares boards_;
    std::unique_ptr<Gateway> gateway_;
    std::vector<std::unique_ptr<Exports>> exports_;
    std::optional<bool> home_assistant_there_;  // as it says itself
    std::unique_ptr<http::Server> server_;
    std::optional<std::filesystem::file_time_type> tokens_read_, tokens_seen_;  // when it was written
    Time tokens_checked_{};
    program::BrokerLog broker_log_;
    int status_ = 0;
};

/// `asip-gateway token`: adds a line to the file and prints the token, once. The file keeps owner and rights;
/// a new one is readable by its owner alone, or by the service's group where root makes it. Returns the exit
/// status; on a fault the file stays as it was.
int make_token(const TokenRequest& request);

/// `asip-gateway export`: switches an export of the installed service on or off. Returns the exit status; on
/// a fault the file stays as it was.
int switch_export(const ExportSwitch& request);

}  // namespace asip::gateway
