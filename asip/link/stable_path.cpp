// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include "asip/link/serial_port.hpp"

namespace asip::link {

std::string stable_path(const std::string& device, const std::string& by_id) {
    namespace fs = std::filesystem;
    std::error_code error;
    const auto target = fs::canonical(device, error);
    if (error) return device;
    std::string found;
    for (const auto& entry : fs::directory_iterator(by_id, error)) {
        std::error_code ignored;
        if (fs::canonical(entry.path(), ignored) != target) continue;
        // One device can have several links; the first in the order of names, so that each run picks the
        // same.
        if (found.empty() || entry.path().string() < found) found = entry.path().string();
    }
    return found.empty() ? device : found;
}

}  // namespace asip::link
