// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::agent {

/// asip-agent, from its command line to its exit status.
int run_program(int argc, const char* const* argv);

}  // namespace asip::agent
