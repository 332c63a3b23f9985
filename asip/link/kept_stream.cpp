// SPDX-License-Identifier: Apache-2.0
#include "asip/link/kept_stream.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <optional>
#include <utility>

#include "asip/link/serial_port.hpp"

namespace asip::link {
namespace {

constexpr auto kRetry = std::chrono::milliseconds(250);
// For a port that is there: opening it may move its lines under another program, and hardly helps.
constexpr auto kRetryRefused = std::chrono::milliseconds(1000);
constexpr auto kDtrLow = std::chrono::milliseconds(100);
constexpr Duration kConnectTimeout = std::chrono::seconds(5);

}  // namespace

class KeptStream::Impl : public std::enable_shared_from_this<Impl> {
  public:
    Impl(boost::asio::io_context& io, StreamTarget target, Handlers handlers)
        : io_(io), target_(std::move(target)), handlers_(std::move(handlers)), timer_(io) {
        if (const auto* serial = std::get_if<SerialTarget>(&target_)) path_ = stable_path(serial->device);
    }

    void start() {
        stopped_ = false;
        open_later(std::chrono::milliseconds(0));
    }

    void open_later(std::chrono::milliseconds delay) {
        timer_.expires_after(delay);
        timer_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
            if (const auto self = weak.lock(); self && !error && !self->stopped_) self->open();
        });
    }

    void stop() {
        stopped_ = true;
        timer_.cancel();
        connecting_.reset();
        release();
    }

    void write(std::string_view bytes) {
        if (!stream_) return;
        if (change_)
            change_->held += bytes;
        else
            stream_->write(bytes);
        const auto waiting = stream_->unsent_bytes() + (change_ ? change_->held.size() : 0);
        if (waiting > kMaxUnsentBytes) reopen("the port accepts no more bytes");
    }

    void set_rate(unsigned baud, std::function<void(bool)> done) {
        if (!serial_) {
            boost::asio::post(io_, [done = std::move(done)] { done(false); });
            return;
        }
        change_ = RateChange{baud, std::move(done), {}};
        stream_->when_sent([weak = weak_from_this()] {
            if (const auto self = weak.lock()) self->apply_rate();
        });
    }

    bool restart_board() {
        if (!serial_ || !serial_->set_dtr(false)) return false;
        timer_.expires_after(kDtrLow);
        timer_.async_wait([weak = weak_from_this()](const boost::system::error_code& error) {
            if (const auto self = weak.lock(); self && !error && self->serial_) self->end_dtr_pulse();
        });
        return true;
    }

    void reopen(std::string why) {
        if (!stream_) return;
        boost::asio::post(io_, [weak = weak_from_this(), why = std::move(why), number = opened_] {
            const auto self = weak.lock();
            if (self && self->stream_ && self->opened_ == number)
                self->lost({StreamError::Kind::kClosed, self->stream_->describe() + ": " + why});
        });
    }

  private:
    struct RateChange {
        unsigned baud = 0;
        std::function<void(bool)> done;
        std::string held;  // written since; leaves at the new rate
    };

    void open() {
        if (const auto* address = std::get_if<TcpAddress>(&target_)) return open_tcp(*address);
        const auto& target = std::get<SerialTarget>(target_);
        auto port = open_serial(io_, path_, static_cast<int>(target.baud));
        // Between two boards of one kind the by-id name may be missing for a while; the name given is as good
        // then.
        if (!port && port.error().kind == StreamError::Kind::kNotThere && path_ != target.device) {
            if (auto other = open_serial(io_, target.device, static_cast<int>(target.baud)))
                port = std::move(other);
        }
        if (!port) return failed(port.error());
        path_ = stable_path((*port)->describe());
        serial_ = port->get();
        opened(std::move(*port));
        bool restarting = false;
        if (target.dtr == DtrAtOpen::kPulse && restart_board()) return;
        if (target.dtr == DtrAtOpen::kRaise) restarting = serial_->set_dtr(true);
        handlers_.on_up({target.baud, restarting, path_});
    }

    void open_tcp(const TcpAddress& address) {
        connecting_ = connect_tcp(io_, address, kConnectTimeout, [weak = weak_from_this()](auto stream) {
            const auto self = weak.lock();
            if (!self || self->stopped_) return;
            if (!stream) return self->failed(stream.error());
            self->opened_tcp(std::move(*stream));
        });
    }

    void opened_tcp(std::unique_ptr<ByteStream> stream) {
        opened(std::move(stream));
        const auto& address = std::get<TcpAddress>(target_);
        handlers_.on_up({0, false, address.host + ":" + std::to_string(address.port)});
    }

    void opened(std::unique_ptr<ByteStream> stream) {
        stream_ = std::move(stream);
        ++opened_;
        stream_->start({[weak = weak_from_this()](std::string_view bytes) {
                            if (const auto self = weak.lock(); self && !self->stopped_)
                                self->handlers_.on_bytes(bytes);
                        },
                        [weak = weak_from_this()](const StreamError& error) {
                            if (const auto self = weak.lock(); self && !self->stopped_) self->lost(error);
                        }});
    }

    void failed(const StreamError& error) {
        using Kind = StreamError::Kind;
        const bool refused = error.kind == Kind::kBusy || error.kind == Kind::kNoPermission ||
                             error.kind == Kind::kNotASerialPort;
        open_later(refused ? kRetryRefused : kRetry);
        handlers_.on_failed(error);
    }

    void lost(const StreamError& error) {
        release();
        open_later(kRetry);
        handlers_.on_down(error);
    }

    /// The stream may be in one of its own handlers: it is destroyed from the loop.
    void release() {
        change_.reset();
        if (!stream_) return;
        // Else closing waits, for up to 30 s, until a port that accepts nothing has sent all.
        if (serial_ && stream_->unsent_bytes() > 0) serial_->flush();
        serial_ = nullptr;
        stream_->close();
        boost::asio::post(io_, [stream = std::shared_ptr<ByteStream>(std::move(stream_))] {});
    }

    void end_dtr_pulse() {
        const unsigned baud = std::get<SerialTarget>(target_).baud;
        change_.reset();
        (void)serial_->set_baud(static_cast<int>(baud));
        serial_->flush();
        serial_->set_dtr(true);
        handlers_.on_up({baud, true, path_});
    }

    void apply_rate() {
        if (!serial_ || !change_) return;
        const RateChange change = std::move(*change_);
        change_.reset();
        const bool ok = serial_->set_baud(static_cast<int>(change.baud)).has_value();
        stream_->write(change.held);
        change.done(ok);
    }

    boost::asio::io_context& io_;
    StreamTarget target_;
    Handlers handlers_;
    boost::asio::steady_timer timer_;  // of the next attempt, or of the DTR pulse: never both
    std::string path_;
    std::unique_ptr<ByteStream> stream_;
    SerialPort* serial_ = nullptr;  // stream_, where it is a serial port
    std::shared_ptr<void> connecting_;
    std::optional<RateChange> change_;
    unsigned opened_ = 0;
    bool stopped_ = false;
};

KeptStream::KeptStream(boost::asio::io_context& io, StreamTarget target, Handlers handlers)
    : impl_(std::make_shared<Impl>(io, std::move(target), std::move(handlers))) {}

KeptStream::~KeptStream() {
    impl_->stop();
}

void KeptStream::start() {
    impl_->start();
}

void KeptStream::stop() {
    impl_->stop();
}

void KeptStream::write(std::string_view bytes) {
    impl_->write(bytes);
}

void KeptStream::set_rate(unsigned baud, std::function<void(bool)> done) {
    impl_->set_rate(baud, std::move(done));
}

bool KeptStream::restart_board() {
    return impl_->restart_board();
}

void KeptStream::reopen(std::string why) {
    impl_->reopen(std::move(why));
}

}  // namespace asip::link
