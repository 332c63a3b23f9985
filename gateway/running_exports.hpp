// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/client.hpp"
#include "gateway/export/export.hpp"
#include "gateway/gateway.hpp"

namespace asip::gateway {

/// An export's connection to the broker, there while the export wants it.
class ExportConnection {
  public:
    ExportConnection(boost::asio::io_context& io, mqtt::Options options)
        : io_(io), options_(std::move(options)) {}

    /// This connection's part of the port. `of` is asked for whenever it is needed.
    exports::Export::Port port(std::function<exports::Export&()> of);
    /// Lets go of what has ended. Call now and then.
    void tidy();
    /// Sends what waits and ends; `done` is called within `limit`, or some seconds behind the connection's
    /// own end.
    void stop(Duration limit, std::function<void()> done);

  private:
    void connect(exports::Export& of);
    void tell_soon(exports::Export& of);  ///< that little waits to be sent, if so

    boost::asio::io_context& io_;
    mqtt::Options options_;
    std::unique_ptr<mqtt::Client> client_;
    bool sent_ = false;  // the exporter is told soon
    struct Ending {
        std::unique_ptr<mqtt::Client> client;
        bool done = false;
        std::function<void()> then{};
    };
    std::vector<std::shared_ptr<Ending>> ending_;
};

/// An export with its connection, for the boards of a gateway.
class Exports {
  public:
    Exports(boost::asio::io_context& io, const exports::MakeExport& make, mqtt::Options mqtt,
            Gateway& gateway);

    /// Over the gateway's connection; their messages go to message().
    std::vector<std::string> subscriptions() const { return export_->subscriptions(); }
    void subscribed();
    void disconnected() { export_->disconnected(); }
    /// Ahead of Gateway::message(), for a value of a service.
    void message_of_service(const bus::TopicRef& topic, const mqtt::Message& message);
    /// Behind Gateway::message(), for each message.
    void changes();
    /// On none of the bus's topics.
    void message(const mqtt::Message& message);
    void tick();
    void stop(Duration limit, std::function<void()> done);
    const exports::Export& of() const { return *export_; }

  private:
    exports::Export::Port port();
    void command(const std::string& board, const property::Request& request,
                 std::function<void(std::string)> done);
    std::optional<exports::Export::Present> board(const std::string& name);
    void changed(std::set<std::string> boards, Time now);

    Gateway& gateway_;
    ExportConnection connection_;
    std::unique_ptr<exports::Export> export_;
    std::shared_ptr<void> told_;  // how boards stand
    std::uint64_t seen_ = 0;      // of the gateway's changes
    Rates looks_{10};             // at each board
    std::set<std::string> later_;
};

/// `asip-gateway clean`: clears all that these exports left. Returns the exit status; what happened is
/// printed.
int clean_exports(const std::vector<exports::MakeExport>& exports, const mqtt::Options& mqtt);

}  // namespace asip::gateway
