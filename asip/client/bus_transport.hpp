// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "asip/client/transport.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "asip/bus/request/demander.hpp"
#include "asip/bus/request/requester.hpp"
#include "asip/bus/topics.hpp"
#include "asip/catalogue/bus_view.hpp"
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
    nlohmann::json was_set(const std::string& service) const override;
    std::shared_ptr<void> demand(const std::string& service, double hz) override;
    void close() override;

  private:
    Awaitable<nlohmann::json> request(std::string topic, nlohmann::json payload);
    Expected<void> make_client();
    /// `handler`, called only while this transport is open.
    template <class Handler>
    auto while_alive(Handler handler) {
        return [alive = std::weak_ptr<bool>(alive_), handler = std::move(handler)](const auto& event) {
            if (alive.lock()) {
                handler(event);
            }
        };
    }
    void connected();
    void publish_demands();
    void take(const mqtt::Message& message);
    void take_reply(PendingCalls::Id id, const mqtt::Message& message);
    void take_set(std::string_view service, const mqtt::Message& message);
    void take_event(std::string_view service, const mqtt::Message& message);
    const model::Description* description() const { return view_.description(address_.board); }
    void look_again();
    void failed(const mqtt::ConnectionFailure& failure);
    void denied(const std::string& topic, const std::string& reason);
    std::string why_not_there() const;

    boost::asio::io_context& io_;
    Address address_;
    Options options_;
    bus::Topics topics_;
    std::optional<bus::Requester> requester_;
    std::optional<bus::Demander> demander_;
    boost::asio::steady_timer demand_timer_;
    Listener* listener_ = nullptr;
    std::unique_ptr<mqtt::Client> client_;
    PendingCalls calls_;
    PendingCalls::Id next_id_ = 1;
    /// Topics of what is not yet answered; outlives this with the last call.
    std::shared_ptr<std::map<PendingCalls::Id, std::string>> asked_ =
        std::make_shared<std::map<PendingCalls::Id, std::string>>();
    std::string user_;
    mutable catalogue::BusView view_;  // of this board alone; leases are judged by looking
    boost::asio::steady_timer lease_timer_;
    std::map<std::string, nlohmann::json, std::less<>> set_;      // by service
    std::string failure_;                                         // of the last attempt to connect
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  // until close()
    bool told_ = false;  // over this connection: of what is stored the state may come behind the description
    bool there_ = false;
    bool closed_ = false;
};

}  // namespace asip::client
