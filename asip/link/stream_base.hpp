// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <deque>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "asip/link/byte_stream.hpp"
#include "asip/quick_ack.hpp"

namespace asip::link {

/// Reading into a callback and a queue of writes, over any Asio stream. Operations under way outlive the
/// ByteStream and hold it by shared_ptr.
template <class Socket>
class StreamCore : public std::enable_shared_from_this<StreamCore<Socket>> {
  public:
    StreamCore(Socket socket, std::string name) : socket_(std::move(socket)), name_(std::move(name)) {}

    Socket& socket() { return socket_; }
    const std::string& name() const { return name_; }
    std::size_t unsent_bytes() const { return unsent_; }

    void start(ByteStream::Handlers handlers) {
        handlers_ = std::move(handlers);
        read();
    }

    void write(std::string_view bytes) {
        if (closed_ || bytes.empty()) return;
        unsent_ += bytes.size();
        // Nothing waits and the system takes it: no turn through the loop, no copy.
        if (queue_.empty()) {
            boost::system::error_code error;
            const auto sent = socket_.write_some(boost::asio::buffer(bytes.data(), bytes.size()), error);
            bytes.remove_prefix(sent);
            unsent_ -= sent;
            if (bytes.empty()) return;
        }
        queue_.emplace_back(bytes);
        if (queue_.size() == 1) write_next();
    }

    void when_sent(std::function<void()> done) {
        sent_ = std::move(done);
        if (queue_.empty()) notify_sent();
    }

    void pause_reading(bool paused) {
        paused_ = paused;
        if (!paused_ && !reading_ && !closed_ && !input_ended_ && handlers_.on_bytes) read();
    }

    void close() {
        closed_ = true;
        sent_ = nullptr;
        boost::system::error_code ignored;
        socket_.close(ignored);
    }

  private:
    void read() {
        if (paused_) return note_paused();
        reading_ = true;
        socket_.async_read_some(
            boost::asio::buffer(buffer_),
            [self = this->shared_from_this()](const boost::system::error_code& error, std::size_t size) {
                if (self->closed_) return;
                if (error == boost::asio::error::eof && self->handlers_.on_input_ended) {
                    self->input_ended_ = true;
                    self->handlers_.on_input_ended();
                    return;
                }
                if (error) {
                    self->ended(error);
                    return;
                }
                if (self->handlers_.on_bytes) self->handlers_.on_bytes({self->buffer_.data(), size});
                if (self->closed_) return;
                if constexpr (std::is_same_v<Socket, boost::asio::ip::tcp::socket>)
                    acknowledge_at_once(self->socket_.native_handle());
                self->read();
            });
    }

    void note_paused() { reading_ = false; }

    void write_next() {
        socket_.async_write_some(
            boost::asio::buffer(queue_.front()),
            [self = this->shared_from_this()](const boost::system::error_code& error, std::size_t size) {
                if (self->closed_) return;
                if (error) {
                    self->ended(error);
                    return;
                }
                self->unsent_ -= size;
                auto& first = self->queue_.front();
                first.erase(0, size);
                if (first.empty()) self->queue_.pop_front();
                if (!self->queue_.empty()) return self->write_next();
                if (self->sent_) self->notify_sent();
            });
    }

    void notify_sent() {
        boost::asio::post(socket_.get_executor(), [self = this->shared_from_this()] {
            if (self->queue_.empty() && self->sent_) std::exchange(self->sent_, nullptr)();
        });
    }

    void ended(const boost::system::error_code& error) {
        close();
        if (!handlers_.on_closed) return;
        const bool hung_up =
            error == boost::asio::error::eof || error == boost::asio::error::connection_reset;
        // TCP says so, too, of a peer that never takes the bytes that were written to it.
        const auto kind = error == boost::asio::error::timed_out ? StreamError::Kind::kUnreachable
                                                                 : StreamError::Kind::kClosed;
        handlers_.on_closed(
            {kind, name_ + (hung_up ? " was closed by the other side" : " is gone: " + error.message())});
    }

    Socket socket_;
    std::string name_;
    ByteStream::Handlers handlers_;
    std::array<char, ByteStream::kMaxAtOnce> buffer_;
    std::deque<std::string> queue_;
    std::function<void()> sent_;
    std::size_t unsent_ = 0;
    bool closed_ = false;
    bool input_ended_ = false;
    bool paused_ = false;
    bool reading_ = false;  // an operation is under way, or its handler runs
};

/// `Base`: ByteStream or an interface that extends it.
template <class Socket, class Base = ByteStream>
class CoreStream : public Base {
  public:
    CoreStream(Socket socket, std::string name)
        : core_(std::make_shared<StreamCore<Socket>>(std::move(socket), std::move(name))) {}
    ~CoreStream() override { core_->close(); }

    void start(ByteStream::Handlers handlers) override { core_->start(std::move(handlers)); }
    void write(std::string_view bytes) override { core_->write(bytes); }
    std::size_t unsent_bytes() const override { return core_->unsent_bytes(); }
    void when_sent(std::function<void()> done) override { core_->when_sent(std::move(done)); }
    void pause_reading(bool paused) override { core_->pause_reading(paused); }
    void close() override { core_->close(); }
    std::string describe() const override { return core_->name(); }

  protected:
    Socket& socket() { return core_->socket(); }
    const Socket& socket() const { return core_->socket(); }

  private:
    std::shared_ptr<StreamCore<Socket>> core_;
};

}  // namespace asip::link
