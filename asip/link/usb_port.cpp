// SPDX-License-Identifier: Apache-2.0
#include "asip/link/usb_port.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include "asip/link/serial_port.hpp"

namespace asip::link {

namespace {

namespace fs = std::filesystem;

std::string line_of(const fs::path& file) {
    std::string line;
    std::ifstream stream(file);
    std::getline(stream, line);
    return line;
}

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

UsbPort usb_port_of(const std::string& device, const std::string& sys) {
    std::error_code error;
    const auto name = fs::canonical(device, error).filename();
    if (error) return {};
    auto folder = fs::canonical(fs::path(sys) / "class/tty" / name / "device", error);
    // From the interface, or the port of a converter on it, up to the device itself.
    for (; !error && folder.has_relative_path(); folder = folder.parent_path()) {
        std::error_code ignored;
        if (!fs::exists(folder / "idVendor", ignored)) continue;
        const auto at = folder.filename().string();  // "1-1.3": bus, then ports
        return {line_of(folder / "idVendor"), line_of(folder / "idProduct"), line_of(folder / "serial"),
                at.substr(at.find('-') + 1)};
    }
    return {};
}

// As packaging/udev/70-asip.rules has them.
bool is_own_serial(std::string_view serial) {
    constexpr std::array<std::string_view, 7> kOfAll{
        "", "0", "0000", "0001", "00000000", "12345678", "0123456789ABCDEF"};
    return std::find(kOfAll.begin(), kOfAll.end(), serial) == kOfAll.end();
}

std::string stable_path(const std::string& device, const std::string& folder, const std::string& sys) {
    std::error_code error;
    const auto target = fs::canonical(device, error);
    if (error) return device;
    const auto by_path = fs::path(folder) / "by-path";
    if (fs::path(device).parent_path() == by_path) return device;
    const auto usb = usb_port_of(device, sys);
    // Clones without a number of their own share one link by id; now one of them has it, now another.
    if (!usb.vendor.empty() && !is_own_serial(usb.serial)) {
        const auto at = link_in(by_path, target);
        if (!at.empty()) return at;
    }
    const auto found = link_in(fs::path(folder) / "by-id", target);
    return found.empty() ? device : found;
}

}  // namespace asip::link
