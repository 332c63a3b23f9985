// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::program {

/// Whether the program was started by a service manager that wants to be told (systemd, Type=notify).
bool has_service_manager();

/// Whether the program was started to serve without a person at a terminal who sees it end: by systemd, or as
/// the first process of a container. Then it does not end over what may pass.
bool supervised();

/// Tells it: lines of sd_notify(3), such as "READY=1\nSTATUS=3 boards". Nothing where there is none; never
/// waits.
void tell_service_manager(std::string_view lines);

}  // namespace asip::program
