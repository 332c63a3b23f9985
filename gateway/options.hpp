// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/mqtt/options.hpp"
#include "gateway/export/export.hpp"
#include "gateway/gateway.hpp"

namespace asip::gateway {

/// Checked, but for addresses and files.
struct ProgramOptions {
    GatewayOptions gateway;
    mqtt::Options mqtt;
    std::vector<std::string> addresses;
    std::string http_cert, http_key;  ///< PEM; empty: no TLS
    std::string tokens;               ///< file; empty: none
    std::string services;             ///< folder of further models; empty: none
    std::string cables;               ///< folder of the agent of lent boards; empty: none are lent
    http::ServerLimits limits;
    /// One for each dialect; where it is not enabled what it left on the broker is cleared.
    std::vector<exports::MakeExport> exports;
    std::set<std::string> exports_on;  ///< those that are, by what sends their commands
};

/// `asip-gateway token ROLE NAME`.
struct TokenRequest {
    std::string role;
    std::string name;
    std::string file;
    std::string until;  ///< a duration; empty: it does not expire
    std::vector<std::string> boards, services, frames;
    std::string dashboard;  ///< of a kiosk: shows this and nothing else
    bool control = false;   ///< its switches, sliders and stops may be used
};

/// `asip-gateway export SYSTEM [VALUE]`.
struct ExportSwitch {
    static constexpr const char* kFile = "/etc/asip/gateway.env";

    std::string system;
    std::string value;         ///< empty: the usual one
    std::string file = kFile;  ///< what the service reads its environment from
    bool off = false;
};

struct CommandLine {
    ProgramOptions run;
    std::unique_ptr<ExportSwitch> export_switch;  ///< set: change the service's file and end
    std::unique_ptr<TokenRequest> token;          ///< set: make a token and end
    bool clean = false;                           ///< clear what `run.exports` left on the broker, and end
};

/// From command line, environment and configuration file. Error: the exit status; the reason was printed.
Expected<CommandLine, int> read_options(int argc, const char* const* argv);

/// What may be done without a token; error: why this must not start.
Expected<void> check_access(ProgramOptions& options, const std::string& anonymous,
                            const std::string& loopback, bool behind_proxy);

}  // namespace asip::gateway
