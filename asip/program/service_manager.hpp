// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::program {

/// By systemd, with Type=notify.
bool has_service_manager();

/// No person sees the program end: systemd started it, or it is the first process of a container. Then it
/// does not end over what may pass.
bool supervised();

/// Lines of sd_notify(3), such as "READY=1
/// STATUS=3 boards". Never waits.
void tell_service_manager(std::string_view lines);

}  // namespace asip::program
