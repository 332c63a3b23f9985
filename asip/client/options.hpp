// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>

namespace asip::client {

/// How to reach a board; every member has a working default.
struct Options {
    /// Not an aggregate: g++ 12 destroys an aggregate twice that is a temporary in a co_await expression.
    Options() {}  // NOLINT(modernize-use-equals-default)

    /// Reaching the board: port opened, banner or answer seen, or the board's description found on the bus.
    std::chrono::milliseconds open_timeout{10'000};
    /// One command, until it was executed or can no longer be. Over MQTT it is sent along as the command's
    /// deadline, and kept within 50 ms and 60 s.
    std::chrono::milliseconds command_timeout{5'000};
    /// digital_read and analog_read, when the value has to be asked for or waited for.
    std::chrono::milliseconds read_timeout{1'000};
    /// analog_read returns a reported value at most this old, else waits for the next report.
    std::chrono::milliseconds analog_max_age{1'000};

    // Over MQTT only.
    std::string topic_root = "asip";  ///< of the agent
    std::string user;                 ///< empty: the one in the address, else none
    /// Its first line; a password on a command line is seen by every user of a machine.
    std::string password_file;
    std::string ca;  ///< PEM file of the authority that signed the broker's certificate; for mqtts.
    /// PEM files of this client's own certificate and key, where the broker demands one.
    std::string certificate;
    std::string key;

    // Serial only.
    unsigned baud = 57'600;  ///< rate at which the board starts
    /// Highest rate to step up to where the board can; 0 stays at `baud`.
    unsigned max_baud = 0;
};

}  // namespace asip::client
