// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include "asip/link/serial_port.hpp"
#include "asip/link/usb_port.hpp"

namespace asip::link {
namespace {

namespace fs = std::filesystem;

/// The link in `folder` that leads to `target`; empty: none does.
std::string link_in(const fs::path& folder, const fs::path& target) {
    std::string found;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        std::error_code ignored;
        if (fs::canonical(entry.path(), ignored) != target) continue;
        // One device can have several links; the first in the order of names, so that each run picks the
        // same.
        if (found.empty() || entry.path().string() < found) found = entry.path().string();
    }
    return found;
}

}  // namespace

std::string stable_path(const std::string& device, const std::string& folder, const std::string& sys) {
    std::error_code error;
    const auto target = fs::canonical(device, error);
    if (error) return device;
    const auto by_path = fs::path(folder) / "by-path";
    if (fs::path(device).parent_path() == by_path) return device;
    const auto usb = usb_port_of(device, sys);
    // Of clones without a number of their own one alone has the link by its id, now this one, now that one.
    if (!usb.vendor.empty() && !is_own_serial(usb.serial)) {
        const auto at = link_in(by_path, target);
        if (!at.empty()) return at;
    }
    const auto found = link_in(fs::path(folder) / "by-id", target);
    return found.empty() ? device : found;
}

}  // namespace asip::link
