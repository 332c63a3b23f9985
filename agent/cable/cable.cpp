// SPDX-License-Identifier: Apache-2.0
#include "agent/cable/cable.hpp"

#include <fcntl.h>
#include <pty.h>
#include <sys/inotify.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/link/baud.hpp"
#include "asip/link/stream_base.hpp"

namespace asip::agent {
namespace {

using link::CableKind;
using Descriptor = boost::asio::posix::stream_descriptor;

constexpr int kStartBaud = 57600;  // at which the page opened the board's port
constexpr const char* kGatewayGone = "the gateway that it came through is gone";

std::string text_of(const nlohmann::json& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

Cable::Cable(boost::asio::io_context& io, Socket socket, Handlers handlers)
    : io_(io),
      handlers_(std::move(handlers)),
      gateway_(std::make_unique<link::CoreStream<Socket>>(std::move(socket), "gateway")) {
    gateway_->start({[this](std::string_view bytes) { received(bytes); },
                     [this](const link::StreamError&) { gone(kGatewayGone); }});
}

Cable::~Cable() {
    gone_ = true;
    for (const int fd : {slave_, openings_})
        if (fd >= 0) ::close(fd);
}

Expected<std::string> Cable::open_port() {
    std::array<char, 128> path{};
    termios settings{};
    cfmakeraw(&settings);
    settings.c_cflag |= CREAD | CLOCAL;
    cfsetspeed(&settings, B57600);
    if (::openpty(&master_, &slave_, path.data(), &settings, nullptr) != 0)
        return fail(std::string("no pseudo-terminal: ") + std::strerror(errno));
    Descriptor master(io_, master_);
    for (const int fd : {master_, slave_})
        ::fcntl(fd, F_SETFD, FD_CLOEXEC);
    openings_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (openings_ < 0 || ::inotify_add_watch(openings_, path.data(), IN_OPEN | IN_CLOSE) < 0)
        return fail(std::string("cannot watch a pseudo-terminal: ") + std::strerror(errno));
    baud_ = kStartBaud;
    boost::system::error_code error;
    master.non_blocking(true, error);
    port_ = std::make_unique<link::CoreStream<Descriptor>>(std::move(master), path.data());
    port_->start({[this](std::string_view bytes) { from_program(bytes); },
                  [this](const link::StreamError& end) { gone(end.text); }});
    return std::string(path.data());
}

void Cable::tell(CableKind kind, std::string_view payload) {
    if (!gone_) gateway_->write(link::cable_frame(kind, payload));
}

void Cable::replaced() {
    tell(CableKind::kTaken, "another board was connected in its place");
    if (!port_) return;
    port_->close();
    programs_ = 0;
    gateway_->pause_reading(false);
}

void Cable::received(std::string_view bytes) {
    reader_.take(bytes);
    while (const auto message = gone_ ? std::nullopt : reader_.next())
        take(*message);
}

void Cable::take(const link::CableMessage& message) {
    switch (message.kind) {
        case CableKind::kHello: {
            const auto hello = nlohmann::json::parse(message.payload, nullptr, false);
            if (!port_ && hello.is_object())
                handlers_.on_hello({text_of(hello, "by"), text_of(hello, "vendor"), text_of(hello, "product"),
                                    text_of(hello, "cable"), text_of(hello, "place")});
            return;
        }
        case CableKind::kBytes:
            note_openings();
            // As a serial port does that no program has open.
            if (!port_ || programs_ == 0) return;
            port_->write(message.payload);
            return slow_down();
        case CableKind::kEnd:
            return gone(message.payload);
        default:
            return;
    }
}

// The slower side of both sets the pace.
void Cable::slow_down() {
    for (auto [reads, writes] : {std::pair(gateway_.get(), port_.get()), {port_.get(), gateway_.get()}}) {
        if (writes->unsent_bytes() < kMaxUnsent) continue;
        reads->pause_reading(true);
        writes->when_sent([reads] { reads->pause_reading(false); });
    }
}

// Programs change the rate when all that they wrote has left, and none writes and changes it at once.
void Cable::from_program(std::string_view bytes) {
    if (gone_) return;
    note_openings();
    if (const int baud = link::terminal_baud(master_); baud != baud_ && baud > 0) {
        baud_ = baud;
        tell(CableKind::kRate, std::to_string(baud));
    }
    if (std::exchange(restart_, false)) tell(CableKind::kRestart, {});
    tell(CableKind::kBytes, bytes);
    slow_down();
}

void Cable::note_openings() {
    alignas(inotify_event) std::array<char, 4096> events;
    for (;;) {
        const auto size = ::read(openings_, events.data(), events.size());
        if (size <= 0) return;
        for (std::size_t at = 0; at < static_cast<std::size_t>(size);) {
            const auto* event = reinterpret_cast<const inotify_event*>(events.data() + at);
            at += sizeof(inotify_event) + event->len;
            if ((event->mask & IN_OPEN) != 0) {
                ++programs_;
                restart_ = !std::exchange(first_, false);
            } else if (programs_ > 0) {
                --programs_;
            }
        }
    }
}

void Cable::gone(const std::string& why) {
    if (std::exchange(gone_, true)) return;
    if (port_) port_->close();
    gateway_->close();
    handlers_.on_gone(why);
}

}  // namespace asip::agent
