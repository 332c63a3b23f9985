#include "agent/board_link.hpp"

#include <boost/asio/post.hpp>

#include "asip/link/tcp_stream.hpp"

namespace asip::agent {

namespace {
constexpr auto kRetry = std::chrono::milliseconds(250);
constexpr auto kDtrLow = std::chrono::milliseconds(100);
constexpr auto kDrainPoll = std::chrono::microseconds(200);
constexpr Duration kConnectTimeout = std::chrono::seconds(5);
}  // namespace

BoardLink::BoardLink(boost::asio::io_context& io, const AgentOptions& options, Handlers handlers)
    : io_(io),
      options_(options),
      handlers_(std::move(handlers)),
      path_(options.serial.empty() ? options.tcp : link::stable_path(options.serial)),
      retry_timer_(io),
      drain_timer_(io) {}

BoardLink::~BoardLink() = default;

void BoardLink::start() {
    open();
}

void BoardLink::stop() {
    stopped_ = true;
    retry_timer_.cancel();
    drain_timer_.cancel();
    connecting_.reset();
    serial_ = nullptr;
    stream_.reset();
}

void BoardLink::open() {
    options_.serial.empty() ? open_tcp() : open_serial();
}

void BoardLink::open_serial() {
    auto port = link::open_serial(io_, path_, static_cast<int>(options_.baud));
    // Between two boards of one kind the by-id name may be missing for a while; the name given is as good
    // then.
    if (!port && port.error().kind == link::StreamError::Kind::kNotThere && path_ != options_.serial) {
        auto other = link::open_serial(io_, options_.serial, static_cast<int>(options_.baud));
        if (other) port = std::move(other);
    }
    if (!port) {
        failed(port.error());
        return retry();
    }
    serial_ = port->get();
    model::LinkInfo info{"serial", path_, static_cast<int>(options_.baud)};
    opened(std::move(*port), std::move(info));
}

void BoardLink::open_tcp() {
    const auto address = link::parse_tcp_address(options_.tcp);
    connecting_ = link::connect_tcp(io_, *address, kConnectTimeout, [this](auto stream) {
        if (stream) return opened(std::move(*stream), {"tcp", options_.tcp, 0});
        failed(stream.error());
        retry();
    });
}

void BoardLink::failed(const link::StreamError& error) {
    handlers_.on_failed(error, !std::exchange(tried_, true));
}

void BoardLink::opened(std::unique_ptr<link::ByteStream> stream, model::LinkInfo info) {
    stream_ = std::move(stream);
    info_ = std::move(info);
    tried_ = true;
    wanted_baud_ = 0;
    held_.clear();
    stream_->start({[this](std::string_view bytes) { handlers_.on_bytes(bytes); },
                    [this](const link::StreamError& error) { closed(error); }});
    if (serial_ && options_.reset == ResetPolicy::kAlways && serial_->set_dtr(false)) return pulse_dtr();
    handlers_.on_up({serial_ ? options_.baud : 0, false}, info_);
}

void BoardLink::restart_board() {
    if (serial_ && options_.reset != ResetPolicy::kNever && serial_->set_dtr(false)) pulse_dtr();
}

void BoardLink::pulse_dtr() {
    retry_timer_.expires_after(kDtrLow);
    retry_timer_.async_wait([this](boost::system::error_code error) {
        if (error || !serial_) return;
        (void)serial_->set_baud(static_cast<int>(options_.baud));
        serial_->flush();
        serial_->set_dtr(true);
        handlers_.on_up({options_.baud, true}, info_);
    });
}

void BoardLink::closed(const link::StreamError& error) {
    drain_timer_.cancel();
    wanted_baud_ = 0;
    serial_ = nullptr;
    stream_.reset();
    handlers_.on_down(error);
    retry();
}

void BoardLink::retry() {
    if (stopped_) return;
    retry_timer_.expires_after(kRetry);
    retry_timer_.async_wait([this](boost::system::error_code error) {
        if (!error && !stopped_) open();
    });
}

void BoardLink::write(std::string_view bytes) {
    if (wanted_baud_ != 0) {
        held_ += bytes;
    } else if (stream_) {
        stream_->write(bytes);
    }
}

void BoardLink::set_rate(unsigned baud, std::function<void(bool)> done) {
    if (!serial_) return;
    wanted_baud_ = baud;
    rate_done_ = std::move(done);
    poll_drained();
}

void BoardLink::poll_drained() {
    if (!serial_ || wanted_baud_ == 0) return;
    if (serial_->unsent_bytes() > 0) {
        drain_timer_.expires_after(kDrainPoll);
        drain_timer_.async_wait([this](boost::system::error_code error) {
            if (!error) poll_drained();
        });
        return;
    }
    const bool ok = serial_->set_baud(static_cast<int>(std::exchange(wanted_baud_, 0u))).has_value();
    const std::string held = std::exchange(held_, {});
    if (!held.empty()) stream_->write(held);
    boost::asio::post(io_, [report = std::exchange(rate_done_, nullptr), ok] {
        if (report) report(ok);
    });
}

}  // namespace asip::agent
