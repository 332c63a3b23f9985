// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/connection.hpp"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

namespace asip::gateway::http {
namespace {

namespace asio = boost::asio;
using ErrorCode = boost::system::error_code;

constexpr std::size_t kFairInput = 8 * 1024;  // of a connection, whatever others have
constexpr std::size_t kMaxAhead = 64 * 1024;  // bytes of further requests behind the one being served

// Tells the kernel to report room only when little waits to be sent: what a slow client has not taken stays
// with us, where newer values can take its place.
void keep_unsent_small(Transport::Socket& socket) {
    const int bytes = 16 * 1024;
    setsockopt(socket.native_handle(), IPPROTO_TCP, 25 /* TCP_NOTSENT_LOWAT */, &bytes, sizeof bytes);
}

}  // namespace

Connection::Connection(std::shared_ptr<Shared> shared, Transport transport, Peer peer, std::string address)
    : shared_(std::move(shared)),
      transport_(std::move(transport)),
      peer_(std::move(peer)),
      address_(std::move(address)) {
    ++shared_->counters.open;
    if (address_.empty()) return;
    use_ = &shared_->addresses[address_];
    ++use_->connections;
}

Connection::~Connection() {
    close();
}

bool Connection::count_input(std::size_t bytes) {
    const std::size_t more = bytes - std::min(bytes, counted_);
    shared_->input_bytes = shared_->input_bytes - counted_ + bytes;
    if (use_ != nullptr) use_->input_bytes = use_->input_bytes - counted_ + bytes;
    counted_ = bytes;
    if (more == 0 || bytes <= kFairInput) return true;
    const auto& limits = shared_->limits;
    return shared_->input_bytes <= limits.input_bytes &&
           (use_ == nullptr || use_->input_bytes <= limits.input_bytes_per_address);
}

void Connection::close() {
    if (closed()) return;
    if (source_) --shared_->counters.streams;
    if (websocket_) {
        --shared_->counters.websockets;
        std::exchange(websocket_, nullptr)->close();
    } else if (phase_ != Phase::kWebSocket) {
        transport_.close();
    }
    phase_ = Phase::kClosed;
    --shared_->counters.open;
    source_.reset();
    count_input(0);
    shakes_hands(false);
    if (use_ != nullptr && --use_->connections == 0) shared_->addresses.erase(address_);
    use_ = nullptr;
}

void Connection::leave() {
    if (websocket_) {
        --shared_->counters.websockets;
        std::exchange(websocket_, nullptr)->leave();
    } else if (phase_ == Phase::kStreaming && !write_pending_ && !old_client_) {
        static constexpr std::string_view kEnd = "0\r\n\r\n";
        asio::async_write(transport_, asio::buffer(kEnd.data(), kEnd.size()),
                          [self = shared_from_this()](const ErrorCode&, std::size_t) {});
    }
    close();
}

void Connection::sweep(Time now) {
    if (closed() || !deadline_ || now < *deadline_) return;
    ++shared_->counters.timed_out;
    if (phase_ == Phase::kReading && reader_ && !write_pending_)
        return refuse(408, "the request took too long");
    close();
}

void Connection::read() {
    if (read_pending_ || closed() || in_.size() >= kMaxAhead) return;
    read_pending_ = true;
    transport_.async_read_some(asio::buffer(buffer_),
                               [self = shared_from_this()](const ErrorCode& error, std::size_t bytes) {
                                   self->received(error, bytes);
                               });
}

void Connection::received(const ErrorCode& error, std::size_t bytes) {
    read_pending_ = false;
    if (closed()) return;
    if (error) return close();
    // A client that listens to a stream only ends.
    if (phase_ == Phase::kStreaming) return read();
    in_.append(buffer_.data(), bytes);
    if (phase_ == Phase::kReading) return feed();
    if (!count_input(in_.size())) return close();
    read();
}

void Connection::feed() {
    if (in_.empty()) return read();
    if (!reader_) {
        // An empty line before a request is allowed, and nothing of it.
        in_.erase(0, std::min(in_.size(), in_.find_first_not_of("\r\n")));
        if (in_.empty()) return read();
        reader_.emplace(shared_->limits.request);
        read_bytes_ = 0;
        until(shared_->limits.head_time);
    }
    const bool had_head = reader_->head_done();
    while (!in_.empty() && !reader_->done() && !reader_->error()) {
        const std::size_t used = reader_->feed(in_);
        in_.erase(0, used);
        read_bytes_ += used;
        if (used == 0) break;
    }
    if (reader_->error()) {
        ++shared_->counters.broken;
        return refuse(reader_->error()->status, reader_->error()->text);
    }
    if (reader_->done()) return handle();
    if (!count_input(in_.size() + read_bytes_)) {
        ++shared_->counters.turned_away;
        return refuse(503, "too much of unfinished requests is kept already; try later");
    }
    if (in_.size() > shared_->limits.request.header_bytes + buffer_.size())
        return refuse(431, "the head of the request is too long");
    if (reader_->head_done() && !had_head) {
        until(shared_->limits.body_time);
        if (reader_->wants_continue()) {
            static constexpr std::string_view kGoOn = "HTTP/1.1 100 Continue\r\n\r\n";
            ErrorCode ignored;
            if (transport_.tls() == nullptr)
                transport_.socket().send(asio::buffer(kGoOn.data(), kGoOn.size()), 0, ignored);
        }
    }
    read();
}

void Connection::handle() {
    ++shared_->counters.requests;
    request_ = reader_->take();
    reader_.reset();
    count_input(in_.size() + read_bytes_);
    request_->peer = peer_;
    if (peer_.secure && transport_.tls() == nullptr) return lead_to_tls();
    keep_alive_ = request_->keep_alive;
    head_only_ = request_->method == "HEAD";
    old_client_ = request_->http_1_0;
    phase_ = Phase::kHandling;
    deadline_.reset();
    ++number_;
    asker_ = shared_->asker_of(*request_);
    shared_->shares.add(
        asker_.name,
        [weak = weak_from_this()] {
            const auto self = weak.lock();
            return self && !self->closed() && self->serve();
        },
        asker_.urgent);
}

bool Connection::serve() {
    if (step_) {
        if (waits_for(number_) && step_()) return true;
        step_ = {};
        return false;
    }
    shared_->handler(*request_, Reply(weak_from_this(), number_));
    request_.reset();
    if (phase_ == Phase::kHandling) count_input(in_.size());
    // Not before: a WebSocket takes the socket over, and must find no read under way.
    if (phase_ == Phase::kHandling || phase_ == Phase::kStreaming) read();
    return step_ != nullptr;
}

// Not for ever: a browser would go on where the gateway has no TLS any more.
void Connection::lead_to_tls() {
    constexpr std::string_view kOfAddresses =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789.-:[]";
    const auto host = request_->header("host");
    const bool looks = request_->method == "GET" || request_->method == "HEAD";
    if (!looks || host.empty() || host.find_first_not_of(kOfAddresses) != host.npos ||
        !request_->target.starts_with('/'))
        return refuse(400, "this address wants https:");
    Response response;
    response.status = 307;
    response.headers = {{"Location", "https://" + std::string(host) + request_->target}};
    head_only_ = false;
    std::string head = head_text(response, false, false);
    write(std::move(head), std::move(response), false);
}

void Connection::refuse(int status, std::string_view text) {
    Response response;
    response.status = status;
    response.content_type = "application/problem+json";
    response.body = R"({"title":")" + std::string(reason_phrase(status)) + R"(","status":)" +
                    std::to_string(status) + R"(,"detail":")" + std::string(text) + "\"}";
    head_only_ = false;
    phase_ = Phase::kHandling;
    std::string head = head_text(response, false, false);
    write(std::move(head), std::move(response), false);
}

void Connection::respond(std::uint64_t number, Response response) {
    if (!waits_for(number)) return;
    std::string head = head_text(response, keep_alive_, false);
    write(std::move(head), std::move(response), keep_alive_);
}

void Connection::write(std::string head, Response response, bool keep_alive) {
    phase_ = Phase::kWriting;
    keep_alive_ = keep_alive;
    head_ = std::move(head);
    response_ = std::move(response);
    if (head_only_ || response_.status == 204 || response_.status == 304) {
        response_.body.clear();
        response_.fixed = {};
    }
    until(shared_->limits.write_time);
    write_pending_ = true;
    const auto text = response_.text();
    const std::array<asio::const_buffer, 2> buffers{asio::buffer(head_),
                                                    asio::buffer(text.data(), text.size())};
    asio::async_write(transport_, buffers,
                      [self = shared_from_this()](const ErrorCode& error, std::size_t bytes) {
                          self->written(error, bytes);
                      });
}

void Connection::written(const ErrorCode& error, std::size_t bytes) {
    write_pending_ = false;
    shared_->counters.sent_bytes += bytes;
    if (closed()) return;
    response_ = {};
    head_.clear();
    if (error || !keep_alive_) return close();
    next_request();
}

void Connection::next_request() {
    phase_ = Phase::kReading;
    until(shared_->limits.idle_time);
    if (in_.empty()) in_.shrink_to_fit();
    feed();
}

void Connection::stream(std::uint64_t number, Response head, std::unique_ptr<Source> source) {
    if (!waits_for(number)) return;
    head_ = head_text(head, keep_alive_ && !old_client_, !old_client_);
    if (head_only_) return write(std::exchange(head_, {}), {}, false);
    phase_ = Phase::kStreaming;
    source_ = std::move(source);
    ++shared_->counters.streams;
    in_ = {};
    count_input(0);
    keep_unsent_small(transport_.socket());
    source_->wake = [weak = weak_from_this()] {
        if (auto self = weak.lock()) self->pump_later();
    };
    pump();
}

// One chunk is under way at a time; what comes meanwhile waits in the source.
void Connection::pump() {
    if (taking_) return pump_later();  // the source woke while it was asked
    if (write_pending_ || phase_ != Phase::kStreaming) return;
    std::string text;
    taking_ = true;
    source_->take(text, shared_->limits.stream_bytes);
    taking_ = false;
    last_chunk_ = text.empty() && source_->finished();
    if (text.empty() && head_.empty() && !last_chunk_) {
        if (source_->more()) pump_later();
        return;
    }
    std::string out = std::exchange(head_, {});
    if (old_client_) {
        out += text;
    } else if (!text.empty()) {
        char size[20];
        out.append(size, static_cast<std::size_t>(std::snprintf(size, sizeof size, "%zx\r\n", text.size())));
        out.append(text).append("\r\n");
    }
    if (last_chunk_ && !old_client_) out += "0\r\n\r\n";
    response_.body = std::move(out);
    write_pending_ = true;
    asio::async_write(transport_, asio::buffer(response_.body),
                      [self = shared_from_this()](const ErrorCode& error, std::size_t bytes) {
                          self->chunk_written(error, bytes);
                      });
}

void Connection::pump_later() {
    if (std::exchange(pump_due_, true)) return;
    shared_->shares.add(asker_.name, [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            self->pump_due_ = false;
            self->pump();
        }
        return false;
    });
}

void Connection::in_turns(std::uint64_t number, bus::Shares::Job step) {
    if (waits_for(number)) step_ = std::move(step);
}

void Connection::chunk_written(const ErrorCode& error, std::size_t bytes) {
    write_pending_ = false;
    shared_->counters.sent_bytes += bytes;
    if (closed()) return;
    response_.body = {};
    if (error || last_chunk_) return close();
    pump_later();
}

void Connection::upgrade(std::uint64_t number, std::unique_ptr<Channel> channel) {
    if (!waits_for(number) || !request_) return;
    phase_ = Phase::kWebSocket;
    deadline_.reset();
    keep_unsent_small(transport_.socket());
    ++shared_->counters.websockets;
    count_input(0);
    websocket_ = WebSocket::start(
        std::move(transport_), *request_, std::move(channel), shared_->limits,
        [self = shared_from_this()](bus::Shares::Job job) {
            self->shared_->shares.add(self->asker_.name, std::move(job));
        },
        [self = shared_from_this()] { self->close(); });
}

}  // namespace asip::gateway::http
