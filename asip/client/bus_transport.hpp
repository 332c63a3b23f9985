// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/client/transport.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/bus/topics.hpp"
#include "asip/caller/caller.hpp"
#include "asip/client/address.hpp"
#include "asip/client/options.hpp"
#include "asip/client/pending_calls.hpp"
#include "asip/model/description.hpp"
#include "asip/mqtt/client.hpp"

namespace asip::client {

/// A board by its name, through an MQTT broker and the board's agent. There while the broker is connected and
/// the state of the board is "online", as every program that looks at the bus sees it.
class BusTransport final : public Transport {
  public:
    /// `address` of kind Mqtt.
    BusTransport(boost::asio::io_context& io, Address address, Options options);
    ~BusTransport() override;

    boost::asio::any_io_executor executor() const override { return io_.get_executor(); }
    Awaitable<void> open(Listener& listener) override;
    Awaitable<nlohmann::json> command(std::string service, nlohmann::json command) override;
    Awaitable<void> raw(std::string line) override;
    std::string board_name() const override { return address_.board; }
    std::vector<ServiceInfo> services() const override;
    std::map<std::string, std::string> labels() const override;
    nlohmann::json values(const std::string& service) const override;
    std::shared_ptr<void> demand(const std::string& service, double hz) override;
    void close() override;

  private:
    Awaitable<nlohmann::json> request(std::string topic, nlohmann::json payload);
    Expected<void> make_client();
    /// `handler`, called only while this transport is open.
    template <class Handler>
    auto while_alive(Handler handler) {
        return [alive = std::weak_ptr<bool>(alive_), handler = std::move(handler)](const auto& event) {
            if (alive.lock()) handler(event);
        };
    }
    void connected();
    void wake();
    void wake_in_time();
    void take(const mqtt::Message& message);
    void take_values(const mqtt::Message& message);
    void take_event(std::string_view service, const mqtt::Message& message);
    const model::Description* description() const {
        return caller_ ? caller_->boards().description(address_.board) : nullptr;
    }
    void look_again();
    void look_if_changed();
    void failed(const mqtt::ConnectionFailure& failure);
    std::string why_not_there();

    boost::asio::io_context& io_;
    Address address_;
    Options options_;
    bus::Topics topics_;
    boost::asio::steady_timer timer_;  // of caller_
    std::optional<Time> wakes_at_;
    Listener* listener_ = nullptr;
    std::unique_ptr<mqtt::Client> client_;
    std::optional<caller::Caller> caller_;
    std::string user_;
    bool changed_ = false;  // something else is known of the board
    PendingCalls calls_;
    PendingCalls::Id next_id_ = 1;
    std::map<std::string, nlohmann::json, std::less<>> values_;   // by property: those that are known
    std::string failure_;                                         // of the last attempt to connect
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  // until close()
    bool there_ = false;
    bool closed_ = false;
};

}  // namespace asip::client
