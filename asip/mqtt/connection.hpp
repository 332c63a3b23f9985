// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <mosquitto.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "asip/mqtt/client.hpp"
#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/mqtt/quirks/receives_nothing.hpp"
#include "asip/mqtt/tls.hpp"

namespace asip::mqtt {

/// Reports of a connection, from the io_context only.
class ConnectionEvents {
  public:
    virtual void connection_up(const Connected& connected) = 0;
    /// The last call: the attempt failed, the connection was lost, or goodbye() is through.
    virtual void connection_down(const ConnectionEnd& end) = 0;
    virtual void message_received(Message message) = 0;
    virtual void publish_answered(int id, int reason_code) = 0;
    virtual void subscribe_answered(int id, const std::vector<int>& granted) = 0;
    virtual void unsubscribe_answered(int id) = 0;
    virtual void may_write() = 0;     ///< all that was handed over is in the socket
    virtual void tick(Time now) = 0;  ///< about once a second
    virtual void debug_line(const std::string& line) = 0;

  protected:
    ~ConnectionEvents() = default;
};

/// A libmosquitto instance for one connection, so that no state of an old connection reaches a new one.
/// libmosquitto may close its socket inside almost any call; so the io_context watches a duplicate, which
/// stays valid until Asio has noticed.
class Connection : public std::enable_shared_from_this<Connection> {
  public:
    Connection(boost::asio::io_context& io, const Options& options, BrokerAddress broker, std::string host,
               bool v5, ConnectionEvents& events);
    ~Connection();

    void open();

    /// Sends DISCONNECT; connection_down() follows, unless the broker hangs.
    void goodbye();

    /// Ends without DISCONNECT and without a report.
    void abandon();

    /// Ends without DISCONNECT; reports `failure` from the io_context.
    void fail(ConnectionFailure failure);

    bool up() const { return phase_ == Phase::kUp; }
    bool v5() const { return v5_; }
    /// The broker's, once up().
    int max_qos() const { return max_qos_; }
    /// Unacknowledged QoS 1 messages that the broker allows (MQTT 5.0, 3.2.2.3.3). libmosquitto holds back
    /// more.
    std::size_t receive_maximum() const { return receive_maximum_; }
    /// Bytes wait to be read, so this program is slow.
    bool has_unread() const;

    /// A PUBLISH would go straight to the socket.
    bool ready_to_write() const { return up() && !mosquitto_want_write(mosquitto_.get()); }

    /// Returns libmosquitto's error; publish_answered() will name `id`.
    int publish(const Message& message, int& id);
    int subscribe(const std::string& filter, const SubscribeOptions& options, int& id);
    int unsubscribe(const std::string& filter, int& id);

  private:
    static constexpr int kMinKeepalive = 5;  ///< of libmosquitto, in seconds
    enum class Phase { kConnecting, kUp, kLeaving, kDown };
    struct Destroy {
        void operator()(mosquitto* instance) const { mosquitto_destroy(instance); }
    };

    int configure();
    int configure_tls();
    void limit_packets();
    void set_callbacks();
    void watch();
    bool duplicate_socket();
    void arm();
    void wait_for(boost::asio::posix::stream_descriptor::wait_type what, bool Connection::* armed);
    void serve();
    void read_all();
    void gather();
    bool waits_for_bytes() const;
    int write_out();             ///< what is queued; while serving, only once all has been read
    int send_queued(int error);  ///< behind a call of libmosquitto that queues a packet, and its result
    bool still_open();
    bool tcp_established();
    void schedule_tick();
    void tick();
    bool is_cut_off(Time now);
    void await_close();
    void end(const ConnectionEnd& reason);
    ConnectionEnd why_closed(int error) const;
    ConnectionEnd closed_unanswered() const;

    void on_connect(int code, const mosquitto_property* properties);
    void on_disconnect(int code);
    void on_message(const mosquitto_message& message, const mosquitto_property* properties);
    void on_log(int level, const char* line);

    boost::asio::io_context& io_;
    const Options& options_;
    const BrokerAddress broker_;
    const std::string host_;  ///< the address that is connected to
    const bool v5_;
    ConnectionEvents& events_;

    std::unique_ptr<Tls> tls_;  ///< outlives mosquitto_, which uses its context
    std::unique_ptr<mosquitto, Destroy> mosquitto_;
    boost::asio::posix::stream_descriptor socket_;
    boost::asio::steady_timer timer_;
    boost::asio::steady_timer gather_timer_;
    Time opened_{};
    ReceivesNothing receives_nothing_;
    Phase phase_ = Phase::kConnecting;
    bool tcp_connected_ = false;
    bool read_armed_ = false;
    bool write_armed_ = false;
    unsigned duplicates_ = 0;  ///< counts the sockets that were watched
    bool serving_ = false;
    bool comes_back_ = false;    // for what TLS has read
    bool gathers_ = false;       ///< see Options::gather
    bool closing_ = false;       ///< what the broker still sends is thrown away
    unsigned packets_seen_ = 0;  ///< counts callbacks, to learn whether reading again may give more
    int connack_code_ = 0;
    std::uint8_t max_qos_ = 2;
    std::uint16_t receive_maximum_ = 65535;
    int disconnect_code_ = 0;
    std::string tls_detail_;
};

}  // namespace asip::mqtt
