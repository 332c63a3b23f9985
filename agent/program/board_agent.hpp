// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "agent/bridge/bridge.hpp"
#include "agent/clients/point_to_point.hpp"
#include "agent/command/notes_to_tell.hpp"
#include "agent/counts/board_log.hpp"
#include "agent/describe/label_files.hpp"
#include "agent/inbound/inbox.hpp"
#include "agent/port/link_framing.hpp"
#include "agent/port/port_outage.hpp"
#include "agent/program/broker_reports.hpp"
#include "agent/program/loader.hpp"
#include "agent/program/option_checks.hpp"
#include "agent/program/stop_line.hpp"
#include "agent/safety/stop_files.hpp"
#include "asip/bus/shares.hpp"
#include "asip/link/kept_stream.hpp"
#include "asip/mqtt/backoff.hpp"
#include "asip/mqtt/client.hpp"

namespace asip::agent {

/// The agent of one board: the pure bridge, and all that touches the world: the links to board and broker,
/// the TCP server for clients, timers, disk and clock. It passes what happens into the bridge and performs
/// the effects. One thread: all calls and handlers on the io_context.
class BoardAgent {
  public:
    /// What all boards of the process share.
    struct Host {
        boost::asio::io_context& io;
        boost::asio::thread_pool& disk;  ///< a slow one must not hold up the boards
        StopLines& stops;
        std::set<BoardAgent*>& agents;  ///< of this process
        bool goes_on = false;           ///< does not end over what may pass
        bool several = false;           ///< each line of the log says which board it is about
    };
    /// Another board is at the port: to be started again at once.
    static constexpr int kBeginAnew = -1;
    struct Handlers {
        /// `status`: an exit status, or kBeginAnew. The agent may be destroyed.
        std::function<void(int status)> on_ended;
        std::function<void()> on_changed;
    };

    BoardAgent(const Host& host, AgentOptions options, Handlers handlers);
    ~BoardAgent();
    BoardAgent(const BoardAgent&) = delete;
    BoardAgent& operator=(const BoardAgent&) = delete;

    /// Opens the port and listens for clients. The broker follows once the board is known.
    void start();
    /// Makes the board safe, says goodbye and ends, within 1.5 s; then on_ended is called.
    void stop();

    /// The board's on the bus; empty: it was not announced yet.
    std::string name() const { return bridge_.name_claimed() ? bridge_.name() : std::string(); }
    /// The board answers and is on the bus.
    bool online() const { return presence_ == Presence::kOnline; }
    /// Why board or broker cannot be reached, as far as known.
    const std::string& why_waiting() const {
        return bridge_.why_unreached().empty() ? why_no_broker_ : bridge_.why_unreached();
    }

  private:
    /// kMakingSafe: before it ends.
    enum class Life { kRunning, kMakingSafe, kEnded };
    enum class Presence { kAway, kOnline };

    bool ended() const { return life_ == Life::kEnded; }
    /// The only way into the bridge: passes time and empty effects, and performs these.
    template <class Call>
    void with_bridge(Call&& call);
    void perform(Effects& effects);
    void write(const std::vector<session::Action>& actions);
    void publish(Effects& effects);
    void tell_notes();

    // The connection to the broker (board_agent_bus.cpp)
    void connect_bus();
    void subscribe_to_commands();
    /// The bus brings all that users say to the board, or no longer does.
    void note_subscribed();
    void bus_gone();
    void stops_heard(bool heard, const std::string& why);
    void wait_for_stops();
    Expected<void> use_credentials(const std::string& file);
    bool look_for_credentials();

    // Time
    void arm_timer();
    /// Call it first: what is read after a pause of the process may have waited as long.
    void note_running();

    // The end
    void end_once_safe(std::function<void()> end);
    void wait_until_safe(Time limit, std::function<void()> end);
    void wait_until_left(Time limit, std::function<void()> end);
    void finish(int status);

    // The link to the board
    void link_received(std::string_view bytes);
    void link_opened(const link::StreamOpened& opened);
    void link_lost(const link::StreamError& error);
    void link_failed(const link::StreamError& error);
    void board_heard();

    mqtt::Client::Handlers bus_handlers();
    void bus_failed(const mqtt::ConnectionFailure& failure, bool was_connected);
    void board_silent_at_start();
    void report_counters();
    void publish_statistics(Duration after);
    /// See member::take_stray_answers().
    void drop_stray_answers(Effects& effects);
    void publish_log();
    void note_online();
    void load(Effects::Load wanted);
    void keep_labels(LabelsToKeep keep);
    void keep_stop(std::optional<model::StopInfo> stopped);

    // Links (board_agent_links.cpp): boards of one process are sources for each other without a broker, other
    // sources have a connection of their own. Each is heard within its share: none delays a command.
    void keep_links(std::vector<LinkToKeep> links);
    void subscribe_to_sources();
    mqtt::Client::Handlers source_handlers();
    void sources_heard(bool heard);
    void look_for_neighbours();
    void tell_neighbours();
    void hear_neighbour(const std::string& source);
    void hear_soon(const std::string& source);
    void hear_source(const mqtt::Message& message);
    void share_turn();

    // Messages of the bus. Commands take turns: a few in each turn of the loop, and none while more arrive.
    void message_received(const mqtt::Message& message);
    /// Or waits until a check of CommandAge is due.
    void check_the_way();
    void take(const Inbound& message);
    void ask_for_turn(Inbox& inbox);
    void note_published(const std::string& topic);

    AgentOptions options_;
    const bus::Topics topics_;
    LabelFiles label_files_;
    StopFiles stop_files_;
    LinkFiles link_files_;
    const Host host_;
    const Handlers handlers_;
    boost::asio::io_context& io_;
    BoardLog log_;
    BrokerReports reports_;
    Bridge bridge_;
    LinkFraming framing_;
    link::KeptStream link_;
    PointToPoint clients_;
    std::unique_ptr<mqtt::Client> bus_;
    std::unique_ptr<mqtt::Client> source_bus_;  // once there is a link with a source elsewhere
    std::shared_ptr<StopLine> stop_line_;
    StopLine::Listening stops_;
    bool hears_stops_ = false;
    bool stops_missing_ = false;  // and that was said
    bool announced_ = false;      // over the present connection
    std::string why_no_stops_ = "the broker does not answer";
    boost::asio::steady_timer timer_;
    boost::asio::steady_timer reset_timer_;
    boost::asio::steady_timer counters_timer_;
    boost::asio::steady_timer statistics_timer_;
    boost::asio::steady_timer safe_timer_;
    boost::asio::steady_timer check_timer_;
    boost::asio::steady_timer stops_timer_;
    std::optional<Loader> loader_;  // while firmware is loaded
    NotesToTell notes_;
    Inbox inbox_;
    Inbox link_inbox_;                 // no command waits behind a request for a link
    std::optional<Time> reads_since_;  // what sockets hold may have been sent since then
    PortOutage outage_;
    mqtt::Backoff bus_patience_{std::chrono::minutes(1), std::chrono::minutes(5)};  // as a service
    std::optional<Time> armed_for_;
    bus::Shares shares_;
    bus::BoardShares source_shares_;
    bus::BoardShares demand_shares_;  // of users: where they ask for more, the newest of each program counts
    std::set<std::string> sources_;   // what is subscribed to for links
    std::uint64_t sources_of_ = 0;    // Bridge::source_changes()
    std::uint64_t told_ = 0;          // Bridge::standing_changes()
    std::set<std::string> heard_;     // neighbours
    std::set<std::string> to_hear_;   // those of them that are heard in the next turn of the loop
    bool in_bridge_ = false;          // what the bridge wants done is not done yet
    Life life_ = Life::kRunning;
    Presence presence_ = Presence::kAway;
    std::string why_no_broker_;
    std::string why_no_sources_;
    std::shared_ptr<const void> alive_ = std::make_shared<char>();  // posted calls hold it weakly
};

template <class Call>
void BoardAgent::with_bridge(Call&& call) {
    if (ended()) return;
    note_running();
    Effects effects;
    const bool nested = std::exchange(in_bridge_, true);
    call(Clock::now(), effects);
    write(std::exchange(effects.link, {}));
    tell_neighbours();  // whose boards are written to before anything of this one is published
    bridge_.publish_values(Clock::now(), effects);
    perform(effects);
    in_bridge_ = nested;
    if (ended()) return;
    clients_.resume();
    look_for_neighbours();
    arm_timer();
    note_online();
}

}  // namespace asip::agent
