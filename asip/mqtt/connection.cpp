// SPDX-License-Identifier: Apache-2.0
#include "asip/mqtt/connection.hpp"

#include <fcntl.h>
#include <mqtt_protocol.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <cstring>
#include <utility>

#include "asip/mqtt/failure.hpp"
#include "asip/quick_ack.hpp"

namespace asip::mqtt {
namespace {

namespace asio = boost::asio;
using Kind = ConnectionFailure::Kind;

/// libmosquitto reads about one packet a call. It reads for this time before other work of the program gets
/// its turn, and at least this many packets: what a program does once a turn may cost more than a packet.
constexpr Duration kTurn = std::chrono::milliseconds(2);
constexpr int kLeastReads = 16;
constexpr int kInvalidSocket = -1;

struct Library {
    Library() { mosquitto_lib_init(); }
    ~Library() { mosquitto_lib_cleanup(); }
};

}  // namespace

Connection::Connection(asio::io_context& io, const Options& options, BrokerAddress broker, std::string host,
                       bool v5, ConnectionEvents& events)
    : io_(io),
      options_(options),
      broker_(std::move(broker)),
      host_(std::move(host)),
      v5_(v5),
      events_(events),
      socket_(io),
      timer_(io),
      gather_timer_(io),
      receives_nothing_(options.unreceived_timeout) {
    static Library library;
    mosquitto_.reset(mosquitto_new(options_.client_id.c_str(), true, this));
    if (!mosquitto_) throw std::bad_alloc();
}

Connection::~Connection() = default;

void Connection::open() {
    opened_ = Clock::now();
    set_callbacks();
    int error = configure();
    if (error == MOSQ_ERR_SUCCESS) {
        const auto keepalive = std::max(kMinKeepalive, static_cast<int>(options_.keepalive.count()));
        errno = 0;
        error = mosquitto_connect_async(mosquitto_.get(), host_.c_str(), broker_.port, keepalive);
    }
    if (error == MOSQ_ERR_SUCCESS && mosquitto_socket(mosquitto_.get()) != kInvalidSocket) {
        watch();
        return;
    }
    auto reason = why_closed(error);
    asio::post(io_, [self = shared_from_this(), reason = std::move(reason)] { self->end(reason); });
}

void Connection::watch() {
    duplicate_socket();
    arm();
    schedule_tick();
}

bool Connection::duplicate_socket() {
    const int copy = fcntl(mosquitto_socket(mosquitto_.get()), F_DUPFD_CLOEXEC, 0);
    asio::posix::stream_descriptor duplicate(io_);
    boost::system::error_code error;
    if (copy >= 0) duplicate.assign(copy, error);
    if (copy < 0 || error) {
        if (copy >= 0) ::close(copy);
        fail({Kind::kUnreachable, broker_, 0,
              std::string("no file descriptor left: ") + std::strerror(errno)});
        return false;
    }
    socket_ = std::move(duplicate);
    ++duplicates_;
    read_armed_ = write_armed_ = false;
    return true;
}

void Connection::arm() {
    if (phase_ == Phase::kDown || !socket_.is_open()) return;
    if (!read_armed_ && !comes_back_ && !gathers_)
        wait_for(asio::posix::stream_descriptor::wait_read, &Connection::read_armed_);
    if (!write_armed_ && (!tcp_connected_ || mosquitto_want_write(mosquitto_.get())))
        wait_for(asio::posix::stream_descriptor::wait_write, &Connection::write_armed_);
}

// A wait on an earlier duplicate that was over before that one closed says nothing about this one. It would
// begin a second wait beside the first, and each packet would be looked for twice from then on.
void Connection::wait_for(asio::posix::stream_descriptor::wait_type what, bool Connection::* armed) {
    this->*armed = true;
    socket_.async_wait(
        what, [self = shared_from_this(), armed, of = duplicates_](const boost::system::error_code& error) {
            if (error || of != self->duplicates_) return;
            self.get()->*armed = false;
            self->serve();
        });
}

bool Connection::tcp_established() {
    if (tcp_connected_) return true;
    int problem = 0;
    socklen_t size = sizeof problem;
    getsockopt(socket_.native_handle(), SOL_SOCKET, SO_ERROR, &problem, &size);
    if (problem != 0) {
        // A refused connection is ECONNREFUSED: a reset one was accepted, and closed before we looked.
        end(problem == ECONNRESET ? closed_unanswered()
                                  : ConnectionEnd{unreachable(broker_, std::strerror(problem))});
        return false;
    }
    sockaddr_storage peer{};
    size = sizeof peer;
    tcp_connected_ = getpeername(socket_.native_handle(), reinterpret_cast<sockaddr*>(&peer), &size) == 0;
    // Asio keeps watching for writing on a descriptor that was waited on for it once, and wakes up for it
    // after each message.
    return tcp_connected_ && duplicate_socket();
}

/// Whichever direction became ready, both are served: during a TLS handshake reading may need to write and
/// the reverse.
void Connection::serve() {
    if (phase_ == Phase::kDown || serving_) return;
    if (!tcp_established()) {
        arm();
        return;
    }
    serving_ = true;
    read_all();
    serving_ = false;
    if (up() && options_.gather > Duration{}) gather();
    // What is written acknowledges as well.
    const bool writes = still_open() && mosquitto_want_write(mosquitto_.get());
    if (options_.quick_ack && socket_.is_open() && !writes) acknowledge_at_once(socket_.native_handle());
    if (still_open()) {
        const int error = write_out();
        if (error != MOSQ_ERR_SUCCESS) end(why_closed(error));
    }
    if (!still_open()) return;
    if (ready_to_write()) events_.may_write();
    if (still_open()) arm();
}

void Connection::gather() {
    if (std::exchange(gathers_, true)) return;
    gather_timer_.expires_after(options_.gather);
    gather_timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
        self->gathers_ = false;
        if (!error) self->arm();
    });
}

int Connection::write_out() {
    if (serving_ || !tcp_connected_ || !mosquitto_want_write(mosquitto_.get())) return MOSQ_ERR_SUCCESS;
    return mosquitto_loop_write(mosquitto_.get(), 1);
}

void Connection::read_all() {
    const auto until = Clock::now() + kTurn;
    for (int i = 0; phase_ != Phase::kDown && (i < kLeastReads || Clock::now() < until); ++i) {
        const auto before = packets_seen_;
        const int error = mosquitto_loop_read(mosquitto_.get(), 1);
        if (error != MOSQ_ERR_SUCCESS) {
            end(why_closed(error));
            return;
        }
        if (!still_open()) return;
        if (packets_seen_ == before && waits_for_bytes()) return;
    }
    // What TLS has already read no longer shows on the socket: come back without waiting for it.
    // Once, and in place of waiting for it: turns that bring forth two each leave other work none.
    if (broker_.tls && phase_ != Phase::kDown && !std::exchange(comes_back_, true)) {
        asio::post(io_, [self = shared_from_this()] {
            self->comes_back_ = false;
            self->serve();
        });
    }
}

/// A packet without a callback is no end of what TLS has read ahead, which no longer shows on the socket.
bool Connection::waits_for_bytes() const {
    const auto* tls = static_cast<const SSL*>(mosquitto_ssl_get(mosquitto_.get()));
    return tls == nullptr || !SSL_want_nothing(tls);
}

/// libmosquitto closes its socket as soon as it has received or sent a DISCONNECT, whatever call it is in.
bool Connection::still_open() {
    if (phase_ == Phase::kDown || !socket_.is_open()) return false;
    if (mosquitto_socket(mosquitto_.get()) != kInvalidSocket) return true;
    if (phase_ != Phase::kLeaving) {
        end(why_closed(MOSQ_ERR_CONN_LOST));
    } else if (!std::exchange(closing_, true)) {
        shutdown(socket_.native_handle(), SHUT_WR);
        await_close();
    }
    return false;
}

void Connection::schedule_tick() {
    const auto period = up() ? std::chrono::milliseconds(1000) : std::chrono::milliseconds(200);
    timer_.expires_after(period);
    timer_.async_wait([self = shared_from_this()](const boost::system::error_code& error) {
        if (!error && self->phase_ != Phase::kDown) self->tick();
    });
}

void Connection::tick() {
    const auto now = Clock::now();
    if (phase_ == Phase::kConnecting && now - opened_ >= options_.connect_timeout) {
        if (!tcp_connected_) {
            end({unreachable(broker_, "no answer")});
        } else {
            end({{Kind::kNoAnswer, broker_, 0,
                  broker_.describe() +
                      " accepts connections but does not answer; is it an MQTT broker, does it hang?"}});
        }
        return;
    }
    if (tcp_connected_) {
        int error = mosquitto_loop_misc(mosquitto_.get());
        if (error == MOSQ_ERR_SUCCESS) error = write_out();
        if (error != MOSQ_ERR_SUCCESS) {
            end(why_closed(error));
            return;
        }
        if (!still_open()) return;
        if (is_cut_off(now)) {
            end({{Kind::kStalled, broker_, 0, broker_.describe() + " cannot be reached any more"}});
            return;
        }
        if (up()) events_.tick(now);
        if (!still_open()) return;
    }
    arm();
    schedule_tick();
}

bool Connection::is_cut_off(Time now) {
    tcp_info info{};
    socklen_t size = sizeof info;
    if (!up() || getsockopt(socket_.native_handle(), IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return false;
    return receives_nothing_.look(now, info.tcpi_unacked > 0,
                                  std::chrono::milliseconds(info.tcpi_last_ack_recv));
}

bool Connection::has_unread() const {
    int waiting = 0;
    if (comes_back_) return true;
    return tcp_connected_ && ioctl(mosquitto_socket(mosquitto_.get()), FIONREAD, &waiting) == 0 &&
           waiting > 0;
}

void Connection::goodbye() {
    if (phase_ != Phase::kUp) return;
    phase_ = Phase::kLeaving;
    // From inside a callback libmosquitto only queues the packet, and closes the socket without it when the
    // same read holds more.
    asio::post(io_, [self = shared_from_this()] {
        if (!self->still_open()) return;
        mosquitto_disconnect_v5(self->mosquitto_.get(), MQTT_RC_NORMAL_DISCONNECTION, nullptr);
        self->write_out();
        if (self->still_open()) self->arm();
    });
}

/// Closing a socket that still holds unread bytes resets it, and the broker may then lose our last messages
/// and with them DISCONNECT. So the duplicate stays open until the broker has closed its side.
void Connection::await_close() {
    auto scratch = std::make_shared<std::string>(4096, '\0');
    socket_.async_read_some(asio::buffer(*scratch), [self = shared_from_this(), scratch](
                                                        const boost::system::error_code& error, std::size_t) {
        if (self->phase_ == Phase::kDown) return;
        if (error)
            self->end({closed_by(self->broker_, 0)});
        else
            self->await_close();
    });
}

void Connection::abandon() {
    phase_ = Phase::kDown;
    boost::system::error_code ignored;
    timer_.cancel();
    gather_timer_.cancel();
    socket_.close(ignored);
    // Not while libmosquitto is further up the stack.
    asio::post(io_, [self = shared_from_this()] { self->mosquitto_.reset(); });
}

void Connection::fail(ConnectionFailure failure) {
    asio::post(io_, [self = shared_from_this(), failure = std::move(failure)] { self->end({failure}); });
}

void Connection::end(const ConnectionEnd& reason) {
    if (phase_ == Phase::kDown) return;
    abandon();
    events_.connection_down(reason);
}

ConnectionEnd Connection::why_closed(int error) const {
    if (connack_code_ != 0)
        return {refused_by(broker_, connack_code_, options_), v5_ && is_version_refusal(connack_code_)};
    const bool connecting = phase_ == Phase::kConnecting;
    // libmosquitto 2.0.21 tells no code of a refusal in the words of 3.1.1.
    if (connecting && v5_ && error == MOSQ_ERR_MALFORMED_PACKET)
        return {refused_by(broker_, MQTT_RC_UNSUPPORTED_PROTOCOL_VERSION, options_), true};
    if (error == MOSQ_ERR_TLS || error == MOSQ_ERR_TLS_HANDSHAKE || (connecting && !tls_detail_.empty())) {
        return {tls_failed(broker_, tls_ && !tls_->refusal().empty() ? tls_->refusal() : tls_detail_,
                           tls_ && tls_->may_pass())};
    }
    if (error == MOSQ_ERR_EAI || error == MOSQ_ERR_LOOKUP) return {unreachable(broker_, "unknown host")};
    if (error == MOSQ_ERR_KEEPALIVE)
        return {{Kind::kStalled, broker_, 0, broker_.describe() + " does not answer any more"}};
    if (!connecting) return {closed_by(broker_, disconnect_code_)};
    if (!tcp_connected_) {
        const bool known = error == MOSQ_ERR_ERRNO && errno != 0 && errno != EINPROGRESS;
        if (known && errno == ECONNRESET) return closed_unanswered();
        return {unreachable(broker_, known ? std::strerror(errno) : mosquitto_strerror(error))};
    }
    return closed_unanswered();
}

ConnectionEnd Connection::closed_unanswered() const {
    const char* question =
        broker_.tls ? "does it demand a client certificate?" : "is it an MQTT broker, does it expect TLS?";
    return {{Kind::kNoAnswer, broker_, 0,
             broker_.describe() + " closed the connection before answering; " + question},
            false,
            true};
}

}  // namespace asip::mqtt
