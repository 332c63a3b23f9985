#include "asip/mqtt/connection.hpp"

#include <fcntl.h>
#include <mqtt_protocol.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <cstring>

#include "asip/mqtt/failure.hpp"
#include "asip/mqtt/properties.hpp"

namespace asip::mqtt {
namespace {

namespace asio = boost::asio;
using Kind = ConnectionFailure::Kind;

/// libmosquitto reads about one packet a call; this many are read before other work of the program gets its
/// turn.
constexpr int kReadsPerTurn = 64;
constexpr int kInvalidSocket = -1;
constexpr int kMinKeepalive = 5;  // of libmosquitto

struct Library {
    Library() { mosquitto_lib_init(); }
    ~Library() { mosquitto_lib_cleanup(); }
};

const char* or_null(const std::string& text) {
    return text.empty() ? nullptr : text.c_str();
}

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
      timer_(io) {
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

int Connection::configure() {
    auto* m = mosquitto_.get();
    mosquitto_int_option(m, MOSQ_OPT_PROTOCOL_VERSION, v5_ ? MQTT_PROTOCOL_V5 : MQTT_PROTOCOL_V311);
    // Without it a QoS 1 round trip waits for a delayed acknowledgement: 44 ms instead of 0.09.
    mosquitto_int_option(m, MOSQ_OPT_TCP_NODELAY, 1);
    if (!options_.user.empty()) {
        mosquitto_username_pw_set(m, options_.user.c_str(), or_null(options_.password));
    }
    if (options_.will) {
        const auto& will = *options_.will;
        auto properties = v5_ ? will_properties(will) : Properties{};
        const int error = mosquitto_will_set_v5(m, will.topic.c_str(), static_cast<int>(will.payload.size()),
                                                will.payload.data(), will.qos, will.retain, properties.get());
        if (error != MOSQ_ERR_SUCCESS) return error;
        static_cast<void>(properties.release());  // taken over by libmosquitto, on success only
    }
    if (v5_ && options_.max_packet_bytes != 0) limit_packets();
    return broker_.tls ? configure_tls() : MOSQ_ERR_SUCCESS;
}

/// libmosquitto takes properties of CONNECT only in its blocking call. With a port that is none, that call
/// keeps the properties and ends before it connects.
void Connection::limit_packets() {
    mosquitto_property* list = nullptr;
    mosquitto_property_add_int32(&list, MQTT_PROP_MAXIMUM_PACKET_SIZE, options_.max_packet_bytes);
    mosquitto_connect_bind_v5(mosquitto_.get(), host_.c_str(), -1, kMinKeepalive, nullptr, list);
    mosquitto_property_free_all(&list);
}

int Connection::configure_tls() {
    auto made = Tls::make(options_, broker_.host);
    if (!made) {
        tls_detail_ = made.error();
        return MOSQ_ERR_TLS;
    }
    tls_ = std::move(*made);
    auto* m = mosquitto_.get();
    mosquitto_int_option(m, MOSQ_OPT_SSL_CTX_WITH_DEFAULTS, 0);
    return mosquitto_void_option(m, MOSQ_OPT_SSL_CTX, tls_->context());
}

void Connection::set_callbacks() {
    auto* m = mosquitto_.get();
    mosquitto_connect_v5_callback_set(
        m, [](mosquitto*, void* self, int code, int, const mosquitto_property* properties) {
            static_cast<Connection*>(self)->on_connect(code, properties);
        });
    mosquitto_disconnect_v5_callback_set(m, [](mosquitto*, void* self, int code, const mosquitto_property*) {
        static_cast<Connection*>(self)->on_disconnect(code);
    });
    mosquitto_message_v5_callback_set(m, [](mosquitto*, void* self, const mosquitto_message* message,
                                            const mosquitto_property* properties) {
        static_cast<Connection*>(self)->on_message(*message, properties);
    });
    mosquitto_publish_v5_callback_set(
        m, [](mosquitto*, void* self, int id, int code, const mosquitto_property*) {
            auto& connection = *static_cast<Connection*>(self);
            ++connection.packets_seen_;
            connection.events_.publish_answered(id, code);
        });
    mosquitto_subscribe_v5_callback_set(
        m, [](mosquitto*, void* self, int id, int count, const int* granted, const mosquitto_property*) {
            auto& connection = *static_cast<Connection*>(self);
            ++connection.packets_seen_;
            connection.events_.subscribe_answered(id, std::vector<int>(granted, granted + count));
        });
    mosquitto_log_callback_set(m, [](mosquitto*, void* self, int level, const char* line) {
        static_cast<Connection*>(self)->on_log(level, line);
    });
}

void Connection::watch() {
    const int copy = fcntl(mosquitto_socket(mosquitto_.get()), F_DUPFD_CLOEXEC, 0);
    boost::system::error_code error;
    if (copy >= 0) socket_.assign(copy, error);
    if (copy < 0 || error) {
        if (copy >= 0) ::close(copy);
        fail({Kind::kUnreachable, broker_, 0,
              std::string("no file descriptor left: ") + std::strerror(errno)});
        return;
    }
    arm();
    schedule_tick();
}

void Connection::arm() {
    if (phase_ == Phase::kDown || !socket_.is_open()) return;
    if (!read_armed_) {
        read_armed_ = true;
        socket_.async_wait(asio::posix::stream_descriptor::wait_read,
                           [self = shared_from_this()](const boost::system::error_code& error) {
                               self->read_armed_ = false;
                               if (!error) self->serve();
                           });
    }
    if (!write_armed_ && (!tcp_connected_ || mosquitto_want_write(mosquitto_.get()))) {
        write_armed_ = true;
        socket_.async_wait(asio::posix::stream_descriptor::wait_write,
                           [self = shared_from_this()](const boost::system::error_code& error) {
                               self->write_armed_ = false;
                               if (!error) self->serve();
                           });
    }
}

bool Connection::tcp_established() {
    if (tcp_connected_) return true;
    int problem = 0;
    socklen_t size = sizeof problem;
    getsockopt(socket_.native_handle(), SOL_SOCKET, SO_ERROR, &problem, &size);
    if (problem != 0) {
        // A refused connection is ECONNREFUSED: a reset one was taken, and closed before we looked.
        end(problem == ECONNRESET ? closed_unanswered()
                                  : ConnectionEvents::End{unreachable(broker_, std::strerror(problem))});
        return false;
    }
    sockaddr_storage peer{};
    size = sizeof peer;
    tcp_connected_ = getpeername(socket_.native_handle(), reinterpret_cast<sockaddr*>(&peer), &size) == 0;
    return tcp_connected_;
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
    if (still_open() && mosquitto_want_write(mosquitto_.get())) {
        const int error = mosquitto_loop_write(mosquitto_.get(), 1);
        if (error != MOSQ_ERR_SUCCESS) end(why_closed(error));
    }
    serving_ = false;
    if (!still_open()) return;
    if (ready_to_write()) events_.may_write();
    if (still_open()) arm();
}

void Connection::read_all() {
    for (int i = 0; i < kReadsPerTurn && phase_ != Phase::kDown; ++i) {
        const auto before = packets_seen_;
        const int error = mosquitto_loop_read(mosquitto_.get(), 1);
        if (error != MOSQ_ERR_SUCCESS) {
            end(why_closed(error));
            return;
        }
        if (!still_open()) return;
        if (packets_seen_ == before) return;
    }
    // What TLS has already decrypted no longer shows on the socket: come back without waiting for it.
    if (broker_.tls && phase_ != Phase::kDown) {
        asio::post(io_, [self = shared_from_this()] { self->serve(); });
    }
}

/// libmosquitto closes its socket as soon as it has received or sent a DISCONNECT, whatever call it is in.
bool Connection::still_open() {
    if (phase_ == Phase::kDown || !socket_.is_open()) return false;
    if (mosquitto_socket(mosquitto_.get()) != kInvalidSocket) return true;
    if (phase_ == Phase::kLeaving)
        await_close();
    else
        end(why_closed(MOSQ_ERR_CONN_LOST));
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
        const int error = mosquitto_loop_misc(mosquitto_.get());
        if (error != MOSQ_ERR_SUCCESS) {
            end(why_closed(error));
            return;
        }
        if (!still_open()) return;
        if (up()) events_.tick(now);
        if (!still_open()) return;
    }
    arm();
    schedule_tick();
}

void Connection::goodbye() {
    if (phase_ != Phase::kUp) return;
    phase_ = Phase::kLeaving;
    // From inside a callback libmosquitto only queues the packet, and closes the socket without it when the
    // same read holds more.
    asio::post(io_, [self = shared_from_this()] {
        if (!self->still_open()) return;
        mosquitto_disconnect_v5(self->mosquitto_.get(), MQTT_RC_NORMAL_DISCONNECTION, nullptr);
        if (self->still_open()) self->arm();
    });
}

/// Closing a socket that still holds unread bytes resets it, and the broker may then lose our last messages
/// and with them the goodbye. So the duplicate stays open until the broker has closed its side.
void Connection::await_close() {
    shutdown(socket_.native_handle(), SHUT_WR);
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
    socket_.close(ignored);
    // Not while libmosquitto is further up the stack.
    asio::post(io_, [self = shared_from_this()] { self->mosquitto_.reset(); });
}

void Connection::fail(ConnectionFailure failure) {
    asio::post(io_, [self = shared_from_this(), failure = std::move(failure)] { self->end({failure}); });
}

void Connection::end(const ConnectionEvents::End& reason) {
    if (phase_ == Phase::kDown) return;
    abandon();
    events_.connection_down(reason);
}

ConnectionEvents::End Connection::why_closed(int error) const {
    if (connack_code_ != 0) {
        return {refused_by(broker_, connack_code_, options_), v5_ && is_version_refusal(connack_code_)};
    }
    const bool connecting = phase_ == Phase::kConnecting;
    if (error == MOSQ_ERR_TLS || error == MOSQ_ERR_TLS_HANDSHAKE || (connecting && !tls_detail_.empty())) {
        return {tls_failed(broker_, tls_ && !tls_->refusal().empty() ? tls_->refusal() : tls_detail_,
                           tls_ && tls_->may_pass())};
    }
    if (error == MOSQ_ERR_EAI || error == MOSQ_ERR_LOOKUP) return {unreachable(broker_, "unknown host")};
    if (error == MOSQ_ERR_KEEPALIVE) {
        return {{Kind::kStalled, broker_, 0, broker_.describe() + " does not answer any more"}};
    }
    if (!connecting) return {closed_by(broker_, disconnect_code_)};
    if (!tcp_connected_) {
        const bool known = error == MOSQ_ERR_ERRNO && errno != 0 && errno != EINPROGRESS;
        if (known && errno == ECONNRESET) return closed_unanswered();
        return {unreachable(broker_, known ? std::strerror(errno) : mosquitto_strerror(error))};
    }
    return closed_unanswered();
}

ConnectionEvents::End Connection::closed_unanswered() const {
    const char* question =
        broker_.tls ? "does it demand a client certificate?" : "is it an MQTT broker, does it expect TLS?";
    return {{Kind::kNoAnswer, broker_, 0,
             broker_.describe() + " closed the connection before answering; " + question +
                 (options_.will ? advice_on_topic(options_.will->topic) : "")},
            false,
            true};
}

int Connection::publish(const Message& message, int& id) {
    const auto properties = v5_ ? publish_properties(message) : Properties{};
    const int error = mosquitto_publish_v5(mosquitto_.get(), &id, message.topic.c_str(),
                                           static_cast<int>(message.payload.size()), message.payload.data(),
                                           message.qos, message.retain, properties.get());
    if (!serving_) arm();
    return error;
}

int Connection::subscribe(const std::string& filter, const SubscribeOptions& options, int& id) {
    int flags = 0;
    if (v5_ && options.no_local) flags |= MQTT_SUB_OPT_NO_LOCAL;
    if (v5_ && !options.retained) flags |= MQTT_SUB_OPT_SEND_RETAIN_NEVER;
    const int error =
        mosquitto_subscribe_v5(mosquitto_.get(), &id, filter.c_str(), options.qos, flags, nullptr);
    if (!serving_) arm();
    return error;
}

int Connection::unsubscribe(const std::string& filter) {
    const int error = mosquitto_unsubscribe_v5(mosquitto_.get(), nullptr, filter.c_str(), nullptr);
    if (!serving_) arm();
    return error;
}

void Connection::on_connect(int code, const mosquitto_property* properties) {
    ++packets_seen_;
    if (code != 0) {
        connack_code_ = code;
        return;
    }
    phase_ = Phase::kUp;
    Connected connected{broker_, v5_, options_.client_id, 0};
    std::uint32_t limit = 0;
    if (mosquitto_property_read_int32(properties, MQTT_PROP_MAXIMUM_PACKET_SIZE, &limit, false) != nullptr) {
        connected.max_packet_bytes = limit;
    }
    events_.connection_up(connected);
}

void Connection::on_disconnect(int code) {
    ++packets_seen_;
    if (code >= 128) disconnect_code_ = code;
}

void Connection::on_message(const mosquitto_message& received, const mosquitto_property* properties) {
    ++packets_seen_;
    if (phase_ == Phase::kDown) return;
    Message message;
    message.topic = received.topic;
    message.payload.assign(static_cast<const char*>(received.payload),
                           static_cast<std::size_t>(received.payloadlen));
    message.qos = received.qos;
    message.retain = received.retain;
    read_properties(properties, message);
    events_.message_received(std::move(message));
}

void Connection::on_log(int level, const char* line) {
    if (level == MOSQ_LOG_ERR && std::strncmp(line, "OpenSSL Error", 13) == 0) tls_detail_ = line;
    if (phase_ != Phase::kDown) events_.debug_line(line);
}

}  // namespace asip::mqtt
