// SPDX-License-Identifier: Apache-2.0
#include "asip/model/port_name.hpp"

#include <algorithm>
#include <cctype>

#include "asip/model/names.hpp"

namespace asip::model {
namespace {

constexpr std::string_view kByPath = "/by-path/";
constexpr std::size_t kControllerBytes = 3;

/// What tells two USB controllers of one machine apart: "pci-0000:00:14.0" is 140.
std::string short_controller(std::string_view text) {
    if (text.ends_with(".usb")) text.remove_suffix(4);
    std::string known;
    for (const char c : text)
        if (std::isalnum(static_cast<unsigned char>(c)) != 0) known += c;
    return known.substr(known.size() - std::min(known.size(), kControllerBytes));
}

}  // namespace

// "pci-0000:00:14.0-usb-0:1.3:1.0-port0": controller, bus, socket, configuration and interface, port.
std::string name_of_port(std::string_view path, std::string_view host) {
    const auto plain = suggest_name(path.substr(path.rfind('/') + 1));
    const auto folder = path.find(kByPath);
    const auto usb = path.rfind("-usb-");
    if (folder == path.npos || usb == path.npos || usb < folder) return plain;
    const auto controller = path.substr(folder + kByPath.size(), usb - folder - kByPath.size());
    const auto rest = path.substr(usb + 5);
    const auto socket = rest.find(':');
    const auto interface = rest.find(':', socket == rest.npos ? socket : socket + 1);
    if (interface == rest.npos) return plain;
    std::string name(host.substr(0, host.find('.')));
    name += "-usb-" + short_controller(controller) + "-";
    name += rest.substr(socket + 1, interface - socket - 1);
    // All but the first port of a board have a number of their own.
    auto more = rest.substr(interface + 1);
    if (more.ends_with("-port0")) more.remove_suffix(6);
    if (more != "1.0") name += "-" + std::string(more);
    return suggest_name(name);
}

}  // namespace asip::model
