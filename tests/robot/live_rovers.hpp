// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/mosquitto_broker.hpp"

namespace asip::test {

/// Board files of `count` rovers in one world, evenly along its line.
inline std::vector<std::string> rovers_on_one_line(const TempDir& folder, int count, double length_mm) {
    std::vector<std::string> files;
    for (int i = 0; i < count; ++i) {
        const auto name = "mirto" + std::to_string(i);
        const nlohmann::json board{
            {"name", name},
            {"image", ASIP_MIRTO},
            {"world", ASIP_TRACK},
            {"link", folder.file(name)},
            {"parts", {{{"kind", "rover"}, {"name", "rover"}, {"start", i * length_mm / count}}}}};
        files.push_back(folder.write(name + ".json", board.dump()));
    }
    return files;
}

inline std::unique_ptr<ChildProcess> program(std::vector<std::string> words) {
    words.front() = ASIP_PROGRAMS "/" + words.front();
    return std::make_unique<ChildProcess>(std::move(words));
}

inline std::unique_ptr<ChildProcess> agent(const MosquittoBroker& broker, const std::string& port,
                                           const std::string& name) {
    return program({"asip-agent", "--serial", port, "--broker", broker.url(), "--name", name});
}

}  // namespace asip::test
