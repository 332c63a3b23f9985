// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::agent {

/// asip-agent, from its command line to its exit status (asip/program/exit_status.hpp). Prints help and
/// errors of the command line itself; everything else goes to the log.
int run_program(int argc, const char* const* argv);

}  // namespace asip::agent
