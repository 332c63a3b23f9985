// SPDX-License-Identifier: Apache-2.0
// The ports of a board: they open and close, and take what the board sent.
#include <nlohmann/json.hpp>

#include "sim/program/live_board.hpp"

namespace asip::sim {
namespace {

using json = nlohmann::ordered_json;

// Kept for a program that has the port open and does not read.
constexpr std::size_t kMaxUnreadBytes = std::size_t{64} * 1024;

}  // namespace

Expected<void> LiveBoard::open_pty() {
    auto pty = Pty::open();
    if (!pty) return fail(pty.error());
    pty_ = std::move(*pty);
    pty_in_use_ = false;
    if (file_.link.empty()) return {};
    auto link = PortLink::create(file_.link, pty_.path());
    if (!link) return fail(link.error());
    link_ = std::move(*link);
    return {};
}

Expected<void> LiveBoard::open_ports() {
    if (auto opened = open_pty(); !opened) return fail(opened.error());
    if (file_.tcp_port >= 0) {
        auto tcp = TcpPort::listen(file_.tcp_port);
        if (!tcp) return fail(tcp.error());
        tcp_ = std::move(*tcp);
    }
    json details{{"path", pty_.path()}};
    if (!file_.link.empty()) details["link"] = file_.link.string();
    if (tcp_.is_open()) details["tcp"] = tcp_.port();
    happened("port", details);
    return {};
}

void LiveBoard::close_ports() {
    link_ = PortLink();
    pty_ = Pty();
    tcp_.drop_client();
    to_host_.clear();
}

void LiveBoard::send_to_ports() {
    if (to_host_.empty()) return;
    if (tcp_.in_use()) tcp_.write(to_host_);
    const auto taken = pty_in_use_ ? pty_.write(to_host_) : to_host_.size();
    to_host_.erase(0, taken);
    if (to_host_.size() > kMaxUnreadBytes) to_host_.erase(0, to_host_.size() - kMaxUnreadBytes);
}

std::string LiveBoard::shown_port() const {
    if (!plugged_) return "unplugged";
    return pty_.path() + (file_.link.empty() ? "" : " " + file_.link.string());
}

void LiveBoard::happened(std::string_view event, const json& details) {
    reporter_.happened(name(), board_->now(), event, details);
}

}  // namespace asip::sim
