// SPDX-License-Identifier: Apache-2.0
#include "asip/link/usb_port.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

namespace asip::link {
namespace {

namespace fs = std::filesystem;

std::string line_of(const fs::path& file) {
    std::string line;
    std::ifstream stream(file);
    std::getline(stream, line);
    return line;
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

}  // namespace asip::link
