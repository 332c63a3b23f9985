// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "agent/bridge/bridge.hpp"
#include "agent/clients/client_framing.hpp"
#include "asip/expected.hpp"
#include "asip/link/tcp_stream.hpp"
#include "asip/mqtt/options.hpp"
#include "asip/program/options.hpp"

namespace asip::agent {

enum class ResetPolicy { kNever, kAlways, kIfSilent };

struct ListenAddress {
    link::TcpAddress address;
    ClientFraming::Kind framing = ClientFraming::Kind::kUnknown;
};

struct AgentOptions {
    BridgeOptions bridge;
    mqtt::Options mqtt;
    program::BrokerOptions broker;  ///< what `mqtt` was made from
    model::ModelSet models;
    std::filesystem::path state_folder;  ///< where labels are kept; empty: nowhere
    std::string serial;                  ///< device; empty: `tcp`
    std::string tcp;                     ///< HOST:PORT; empty: `serial`
    std::vector<ListenAddress> listen;   ///< for point-to-point clients
    Duration listen_silence = std::chrono::seconds(5);
    Duration statistics = std::chrono::seconds(15);  ///< between two documents; 0: none
    unsigned baud = 57600;
    ResetPolicy reset = ResetPolicy::kIfSilent;
};

}  // namespace asip::agent
