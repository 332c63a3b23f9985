// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "registry/registry.hpp"
#include "tests/unit/gateway/api_bench.hpp"
#include "tests/unit/gateway/export/sparkplug_host.hpp"

/// The programs that show how a board stands, without their sockets.
namespace truth::values {

/// Topic -> payload.
using Retained = std::map<std::string, std::string>;

/// A gateway that came at some time: what the broker kept is the first that it hears.
class Gateway final : asip::gateway::ApiTest {
  public:
    explicit Gateway(const Retained& retained);
    void TestBody() override {}
    using ApiTest::pass;

    void take(const std::string& topic, const std::string& payload, bool stored = false);
    nlohmann::json values(const std::string& board = "uno1");
    nlohmann::json list();
    /// Its connection ends, and is there again: what it publishes then is returned.
    void lost() { gateway_->disconnected(); }
    std::vector<asip::mqtt::Message> back() {
        gateway_->subscribed();
        return published();
    }
    std::vector<asip::mqtt::Message> published() { return std::exchange(published_, {}); }
    /// As the page sets a property: the status, and how many commands it published.
    std::pair<int, std::size_t> put(const nlohmann::json& value);
    asip::gateway::Gateway& core() { return *gateway_; }
};

/// A registry, likewise. Of a board's properties it has what its description says.
class Registry {
  public:
    explicit Registry(const Retained& retained);
    void take(const std::string& topic, const std::string& payload, bool stored = false);
    void pass(std::chrono::milliseconds time);
    /// The list as programs make it of its answer.
    nlohmann::json list();

  private:
    asip::catalogue::Instant now() const {
        return {time_, asip::text::WallTime(time_.time_since_epoch() / std::chrono::milliseconds(1) *
                                            std::chrono::milliseconds(1))};
    }

    asip::Time time_{std::chrono::seconds(1)};
    std::optional<asip::registry::Registry> registry_;
    std::string answer_;
};

/// One export of a gateway, each seed another one, and the broker that keeps what it retains.
class Exports {
  public:
    explicit Exports(std::uint64_t seed);
    ~Exports();
    const std::string& name() const { return name_; }

    /// Another process, with this gateway. stop() comes first, while its gateway is there.
    void start(asip::gateway::Gateway& gateway);
    void stop();
    /// The broker comes back empty.
    void restart_broker() { world_.restart_broker(false); }
    /// A message, ahead of the gateway and behind it.
    void ahead(const std::string& topic, const std::string& payload);
    void behind();
    void pass(std::chrono::milliseconds time);
    bool is_active() const;

    /// What it shows of a property, as text, and what it would show of a value.
    std::string shown(const std::string& id);
    std::string text_of(const std::string& id, const nlohmann::json& value);

  private:
    using Port = asip::gateway::exports::Export::Port;
    using Property = asip::gateway::exports::Property;
    void wire(Port& port);
    const Property& property(const std::string& id);
    std::unique_ptr<asip::gateway::exports::Export> make(asip::Random random, Port port);

    std::shared_ptr<const asip::gateway::exports::Dialect> dialect_;  // null: Sparkplug
    std::string name_;
    asip::gateway::exports::ExportWorld world_;
    asip::gateway::exports::SparkplugHost host_;
    asip::gateway::Gateway* gateway_ = nullptr;
    std::shared_ptr<void> told_;
    std::shared_ptr<const asip::gateway::exports::ExportedBoard> board_;
    std::uint64_t seen_ = 0;  // of the gateway's changes
    unsigned started_ = 0;
};

}  // namespace truth::values
