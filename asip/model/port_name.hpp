// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace asip::model {

/// A name for a nameless board at this serial port of machine `host`. A port below by-path is called by
/// machine, USB controller and socket, so that no other has its name: `lab-usb-140-3`, behind a hub
/// `lab-usb-140-1.3`. Others are called as their path ends.
std::string name_of_port(std::string_view path, std::string_view host);

}  // namespace asip::model
