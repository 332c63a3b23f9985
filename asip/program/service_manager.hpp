// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::program {

/// Whether the program was started by a service manager that wants to be told (systemd, Type=notify).
bool has_service_manager();

/// Tells it: lines of sd_notify(3), such as "READY=1\nSTATUS=3 boards". Nothing where there is none; never
/// waits.
void tell_service_manager(std::string_view lines);

}  // namespace asip::program
