// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "agent/bridge.hpp"
#include "agent/held_up.hpp"
#include "agent/inbox.hpp"
#include "agent/label_files.hpp"
#include "agent/log_feed.hpp"
#include "agent/options.hpp"
#include "agent/outage.hpp"
#include "agent/point_to_point.hpp"
#include "asip/link/kept_stream.hpp"
#include "asip/mqtt/client.hpp"
#include "asip/mqtt/outage.hpp"
#include "asip/program/stop_signal.hpp"

namespace asip::agent {

/// The program: owns the bridge and what carries it, and performs what the bridge asks for.
class Application {
  public:
    explicit Application(AgentOptions options);
    ~Application();

    /// Runs until it is stopped, or a fault that retrying cannot mend. Returns the exit status.
    int run();

  private:
    template <class Call>
    void with_bridge(Call&& call);
    void perform(Effects& effects);
    void connect_bus();
    void subscribe_to_commands();
    Expected<void> use_credentials(const std::string& file);
    bool look_for_credentials();
    void arm_timer();
    void stop();
    void end_once_safe(std::function<void()> end);
    void wait_until_safe(Time limit, std::function<void()> end);
    void finish(int status);
    void link_opened(const link::StreamOpened& opened);
    void link_lost(const link::StreamError& error);
    void link_failed(const link::StreamError& error, bool first);
    void board_heard();
    mqtt::Client::Handlers bus_handlers();
    void bus_failed(const mqtt::ConnectionFailure& failure, bool was_connected);
    void board_silent_at_start();
    void report_counters();
    void publish_statistics(Duration after);
    void publish_log();
    void keep_labels(LabelsToKeep keep);
    void message_received(const mqtt::Message& message);
    void handle_oldest();
    void schedule_turn();
    void turn();
    void note_published(const std::string& topic);
    void log_rejections();
    void announcing_denied();

    AgentOptions options_;
    const bus::Topics topics_;
    LabelFiles label_files_;
    boost::asio::io_context io_{1};
    Bridge bridge_;
    link::KeptStream link_;
    PointToPoint clients_;
    std::unique_ptr<mqtt::Client> bus_;
    program::StopSignal stop_signal_;
    boost::asio::steady_timer timer_;
    boost::asio::steady_timer reset_timer_;
    boost::asio::steady_timer counters_timer_;
    boost::asio::steady_timer statistics_timer_;
    boost::asio::steady_timer safe_timer_;
    LogFeed log_feed_;
    Inbox inbox_;
    HeldUp held_up_;
    std::size_t arrived_ = 0;  // commands in this turn of the loop
    bool turn_scheduled_ = false;
    Outage outage_;
    std::optional<Time> armed_for_;
    std::uint64_t logged_dropped_ = 0;
    std::uint64_t logged_refused_ = 0;
    std::uint64_t rejected_before_ = 0;    // by the broker, before this connection
    bool announcement_published_ = false;  // over this connection
    bool rejection_logged_ = false;        // of this connection
    bool denial_logged_ = false;           // since the last announcement that was taken
    mqtt::Outage bus_outage_;
    bool board_ever_known_ = false;
    bool link_tried_ = false;
    bool missing_credentials_logged_ = false;
    bool stop_asked_ = false;
    bool stopping_ = false;
    int status_ = 0;
    std::optional<boost::asio::thread_pool> disk_;  // a slow one must not hold up the board
};

template <class Call>
void Application::with_bridge(Call&& call) {
    if (stopping_) return;
    held_up_.runs(Clock::now(), armed_for_);
    Effects effects;
    call(Clock::now(), effects);
    perform(effects);
    if (stopping_) return;
    clients_.resume();
    arm_timer();
}

}  // namespace asip::agent
