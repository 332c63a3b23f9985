// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::agent {

/// The name for a board that has none and was given none, at a serial port of this path on machine `host`. A
/// port below by-path is called by machine, USB controller and socket, so that it is the only one of its
/// name: `lab-usb-140-3`, behind a hub `lab-usb-140-1.3`. Others are called as their path ends.
std::string name_of_port(std::string_view path, std::string_view host);

}  // namespace asip::agent
