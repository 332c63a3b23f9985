// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/mqtt/options.hpp"
#include "cli/environment.hpp"
#include "cli/secure/trials.hpp"

namespace asip::cli {

/// What came of a trial at the running broker.
enum class Found {
    kAllowed,
    kDenied,
    kPartly,  ///< some of its topics are allowed
    kUnknown  ///< not tried: no connection, or no answer in time
};

/// Tries what `trials` say, all of one user. `subject` connects as that user, `admin` as a user who may
/// publish everything. Fails when one of them cannot connect.
Outcome<std::vector<Found>> try_out(const std::vector<Trial>& trials, const mqtt::Options& subject,
                                    const mqtt::Options& admin, const std::string& root, Duration limit);

/// Whether the broker accepts a connection with these options. Fails when the broker cannot be reached.
Outcome<bool> accepts(mqtt::Options options, Duration limit);

/// Whether a program without user and password may command boards: `stranger` is one that does not exist.
/// A broker of version 3.1.1 does not tell; accepting the connection counts there.
Outcome<bool> is_open(mqtt::Options options, const std::string& root, const std::string& stranger,
                      Duration limit);

}  // namespace asip::cli
