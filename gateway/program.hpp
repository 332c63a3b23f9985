// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace asip::gateway {

/// Runs asip-gateway; returns its exit status (asip/program/exit_status.hpp).
int run_program(int argc, const char* const* argv);

}  // namespace asip::gateway
