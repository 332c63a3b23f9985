// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/websocket.hpp"

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>

namespace asip::gateway::http {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

// What Beast asks of a stream of one's own: how it ends.
void teardown(beast::role_type, Transport& transport, beast::error_code& error) {
    error = {};
    transport.close();
}

template <class Handler>
void async_teardown(beast::role_type, Transport& transport, Handler&& handler) {
    transport.close();
    boost::asio::post(transport.get_executor(),
                      [ended = std::forward<Handler>(handler)]() mutable { ended(beast::error_code{}); });
}

void beast_close_socket(Transport& transport) {
    transport.close();
}

namespace {

constexpr std::size_t kKeptBytes = 4096;  // for the next message
constexpr std::chrono::seconds kHandshakeTime{10};
constexpr std::chrono::seconds kIdleTime{30};  // then a ping is sent, and as long again waited for its answer

beast::http::request<beast::http::empty_body> beast_request(const Request& request) {
    beast::http::request<beast::http::empty_body> result;
    result.method_string(request.method);
    result.target(request.target);
    result.version(11);
    for (const auto& [name, value] : request.headers)
        result.insert(name, value);
    return result;
}

class Running final : public WebSocket, public std::enable_shared_from_this<Running> {
  public:
    Running(Transport transport, std::unique_ptr<Channel> channel, const ServerLimits& limits, InTurn in_turn,
            std::function<void()> ended)
        : stream_(std::move(transport)),
          channel_(std::move(channel)),
          in_turn_(std::move(in_turn)),
          ended_(std::move(ended)) {
        stream_.read_message_max(limits.message_bytes);
        websocket::stream_base::timeout timeout{kHandshakeTime, kIdleTime, true};
        stream_.set_option(timeout);
        stream_.write_buffer_bytes(512);
        stream_.auto_fragment(false);  // else a message is written in pieces of that size, one a turn
        stream_.binary(channel_->binary());
    }

    void run(const Request& request) {
        request_ = beast_request(request);
        stream_.async_accept(request_, [self = shared_from_this()](const beast::error_code& error) {
            if (error || !self->channel_) return self->end();
            self->request_ = {};
            self->open_ = true;
            self->channel_->wake = [weak = self->weak_from_this()] {
                if (auto alive = weak.lock()) alive->pump_later();
            };
            self->read();
            self->pump();
        });
    }

    void leave() override {
        if (channel_) pump();  // its last words
        close_with(websocket::close_code::going_away);
        if (channel_) channel_->wake = [] {};
        channel_.reset();
    }

    void close() override {
        stream_.next_layer().close();
        end();
    }

  private:
    // What comes behind our close frame is passed over until the client's own: a socket that is closed with
    // bytes unread is reset, and the client may never see why it ended.
    void read() {
        stream_.async_read(in_, [self = shared_from_this()](const beast::error_code& error, std::size_t) {
            if (error) return self->end();
            if (self->open_) self->later([](Running& here) { here.received(); });
        });
    }

    // The next message is read once this one had its turn.
    void received() {
        if (!open_) return;
        const auto data = in_.data();
        const bool its_kind = stream_.got_binary() == channel_->binary();
        const bool goes_on =
            its_kind && channel_->received({static_cast<const char*>(data.data()), data.size()});
        in_.consume(in_.size());
        if (in_.capacity() > kKeptBytes) in_.shrink_to_fit();
        if (!goes_on)
            return close_with(its_kind ? websocket::close_code::policy_error
                                       : websocket::close_code::unknown_data);
        read();
    }

    void later(void (*job)(Running&)) {
        in_turn_([weak = weak_from_this(), job] {
            if (const auto self = weak.lock()) job(*self);
            return false;
        });
    }

    // A channel may wake while it is asked: one that goes beyond what its client may have kept does.
    void pump() {
        if (taking_) return pump_later();
        if (writing_ || !open_) return;
        if (const auto code = channel_->close_code(); code != 0) return close_with(code);
        taking_ = true;
        const bool taken = channel_->take(out_);
        taking_ = false;
        if (!taken) {
            if (channel_->more()) pump_later();
            return;
        }
        writing_ = true;
        stream_.async_write(boost::asio::buffer(out_),
                            [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                                self->writing_ = false;
                                if (error) return self->end();
                                self->out_.clear();
                                self->pump_later();
                            });
    }

    void pump_later() {
        if (std::exchange(later_, true)) return;
        later([](Running& here) {
            here.later_ = false;
            here.pump();
        });
    }

    void close_with(std::uint16_t code) {
        if (!open_) return;
        open_ = false;
        stream_.async_close(websocket::close_reason(code),
                            [self = shared_from_this()](const beast::error_code&) { self->end(); });
    }

    void end() {
        open_ = false;
        if (channel_) channel_->wake = [] {};
        channel_.reset();
        if (auto ended = std::exchange(ended_, {})) ended();
    }

    websocket::stream<Transport, false> stream_;  // without compression: 300 kB a client
    std::unique_ptr<Channel> channel_;
    InTurn in_turn_;
    std::function<void()> ended_;
    beast::http::request<beast::http::empty_body> request_;
    beast::flat_buffer in_;
    std::string out_;
    bool open_ = false;
    bool writing_ = false;
    bool taking_ = false;
    bool later_ = false;  // pump() is called again soon
};

}  // namespace

std::shared_ptr<WebSocket> WebSocket::start(Transport transport, const Request& request,
                                            std::unique_ptr<Channel> channel, const ServerLimits& limits,
                                            InTurn in_turn, std::function<void()> ended) {
    auto result = std::make_shared<Running>(std::move(transport), std::move(channel), limits,
                                            std::move(in_turn), std::move(ended));
    result->run(request);
    return result;
}

}  // namespace asip::gateway::http
