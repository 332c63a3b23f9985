// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "agent/program/option_checks.hpp"
#include "asip/expected.hpp"
#include "asip/model/description.hpp"
#include "asip/program/app.hpp"
#include "asip/program/options.hpp"

namespace asip::agent {

/// The options as text, with the defaults that `--help` shows. Times have a unit: "2s", "20ms".
struct RawOptions {
    program::BrokerOptions broker;
    program::LogOptions log;
    std::vector<std::string> listen;
    std::vector<std::string> labels;
    std::string state_dir;
    std::string avrdude = "avrdude", firmware_dir = "/usr/share/asip/firmware";
    std::string listen_silence = "5s", statistics = "15s";
    std::string reports = "shared", fastest_period = "20ms", resting_period = "0s";
    std::string name, serial, tcp, cables, services, reset = "if-silent", terminator;
    std::string topics = "board-side";
    unsigned baud = 57600;
    unsigned max_baud = 1'000'000;
    bool no_step_up = false;
    bool takeover = false;
    bool retain_values = false;
    bool keep_outputs = false;
    bool checksum = false;
    int lease = model::kDefaultLeaseSeconds;
    double patience = 8;
};

/// Declares all options, which fill `raw`.
void declare_options(program::App& app, program::Settings& settings, RawOptions& raw);

/// The standard models, and those of the folder of --services.
Expected<model::ModelSet> load_models(const std::string& folder);

/// The options without the models; or the fault of one of them.
Expected<AgentOptions> checked_options(RawOptions raw);

}  // namespace asip::agent
