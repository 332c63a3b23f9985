// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "agent/bridge/bridge.hpp"
#include "agent/cable/lent.hpp"
#include "agent/clients/client_framing.hpp"
#include "asip/link/tcp_stream.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/program/options.hpp"

namespace asip::agent {

/// When the DTR line restarts the board: never, at each open, or where the board is silent.
enum class ResetPolicy { kNever, kAlways, kIfSilent };

/// Where point-to-point clients connect, or a board with a network listens. The framing is given, or
/// recognised.
struct ListenAddress {
    link::TcpAddress address;
    ClientFraming::Kind framing = ClientFraming::Kind::kUnknown;
};

/// The checked options of one board's agent.
struct AgentOptions {
    BridgeOptions bridge;
    mqtt::Options mqtt;
    program::BrokerOptions broker;  ///< what `mqtt` was made from
    model::ModelSet models;
    std::filesystem::path state_folder;  ///< where labels are kept; empty: nowhere
    // The board: one of both.
    std::string serial;                 ///< device; empty: `tcp`
    std::string tcp;                    ///< HOST:PORT[/FRAMING]; empty: `serial`
    ListenAddress tcp_address;          ///< the same, read
    std::vector<ListenAddress> listen;  ///< for point-to-point clients
    /// After this silence a client is taken to want plain lines.
    Duration listen_silence = std::chrono::seconds(5);
    Duration statistics = std::chrono::seconds(15);  ///< between two documents; 0: none
    unsigned baud = 57600;                           ///< at which a serial board starts
    ResetPolicy reset = ResetPolicy::kIfSilent;
    std::shared_ptr<const Lent> lent;  ///< by a browser; null: not lent
    std::string avrdude = "avrdude";
    std::string firmware_folder;  ///< of the images that may be loaded into boards
};

}  // namespace asip::agent
