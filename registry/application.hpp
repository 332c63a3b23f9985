#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "asip/bus/topics.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/outage.hpp"
#include "asip/program/stop_signal.hpp"
#include "asip/random.hpp"
#include "registry/catalogue/catalogue.hpp"
#include "registry/options.hpp"
#include "registry/query_service.hpp"
#include "registry/tidier.hpp"
#include "registry/traffic_listener.hpp"

namespace asip::registry {

class History;

/// The program: carries messages and time to the catalogue, and its answers and events to the bus.
class Application {
  public:
    /// Throws std::runtime_error where a service model or the history file cannot be used.
    explicit Application(RegistryOptions options);
    ~Application();

    /// Until SIGINT or SIGTERM, or a broker that will not have us. Returns the exit status.
    int run();

  private:
    Catalogue::Options catalogue_options() const;
    QueryService::Dependencies query_dependencies();
    BusPort bus_port();
    mqtt::Options mqtt_options() const;
    mqtt::Client::Handlers handlers();

    void on_connected(const mqtt::Connected& connected);
    void on_disconnected(const mqtt::ConnectionFailure& failure);
    void on_connect_failed(const mqtt::ConnectionFailure& failure);
    void on_message(const mqtt::Message& message);
    void on_announcement(const mqtt::Message& message, const bus::TopicRef& topic);
    void note_refusal(const mqtt::Message& message, const bus::TopicRef& topic, Refusal refusal);

    void settled();
    void handle(const std::vector<Event>& events, bool decided_here);
    void keep(const Event& event);
    void give_up_history(const std::string& why);
    void tell(const Event& event);
    void tell_reset();
    void publish_state(std::string_view word);
    void publish_stats();

    void schedule_tick();
    void tick();
    void stop();

    static Instant now();

    RegistryOptions options_;
    bus::Topics topics_;
    Random random_;
    boost::asio::io_context io_;
    boost::asio::steady_timer timer_;
    std::unique_ptr<program::StopSignal> stop_signal_;
    Catalogue catalogue_;
    std::unique_ptr<History> history_;
    std::unique_ptr<mqtt::Client> client_;
    std::unique_ptr<Tidier> tidier_;
    std::unique_ptr<TrafficListener> listener_;
    std::unique_ptr<QueryService> queries_;
    std::string run_;         // random, of this start
    std::string epoch_;       // run_ and the number of the connection
    std::string sync_token_;  // comes back behind everything that the broker retains
    Time settle_limit_{};
    Time last_tick_{};
    Time next_stats_{};
    Time started_{};
    bool settling_ = true;
    mqtt::Outage outage_;
    bool reset_due_ = false;  // events were held back: a reset has to be told
    std::uint64_t connections_ = 0;
    std::uint64_t messages_ = 0;
    std::uint64_t queries_answered_ = 0;
    std::uint64_t events_told_ = 0;
    std::uint64_t messages_before_ = 0;  // at the last statistics
    std::set<std::string> complained_;   // "REASON BOARD", logged once
    int status_ = 0;
};

}  // namespace asip::registry
