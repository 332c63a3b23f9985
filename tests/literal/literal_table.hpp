// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace asip::test {

/// One habit of one class of a published client library.
struct LiteralRow {
    std::string library;
    std::string of_class;
    bool utf_frames = false;            ///< each write is a frame of Java's writeUTF
    std::vector<std::string> writes;    ///< in pieces as the client writes or publishes them
    std::vector<std::string> executes;  ///< what ASIP 0.4 executes, in order

    std::string bytes() const {
        std::string all;
        for (const auto& write : writes) {
            if (utf_frames)
                all += {static_cast<char>(write.size() >> 8), static_cast<char>(write.size() & 0xff)};
            all += write;
        }
        return all;
    }
    std::string name() const { return library + ", " + of_class; }
};

/// Those of a channel (serial, tcp, mqtt) of the table tests/literal/literal_bytes.json.
inline std::vector<LiteralRow> literal_rows(const std::string& channel) {
    std::ifstream file(ASIP_LITERAL_BYTES);
    const auto table = nlohmann::json::parse(file);
    std::vector<LiteralRow> rows;
    for (const auto& library : table.at("libraries")) {
        const auto channels = library.at("channels").get<std::vector<std::string>>();
        if (std::find(channels.begin(), channels.end(), channel) == channels.end()) continue;
        for (const auto& row : library.at("rows"))
            rows.push_back({library.at("library"), row.at("class"), library.at("framing") == "utf",
                            row.at("writes").get<std::vector<std::string>>(),
                            row.at("executes").get<std::vector<std::string>>()});
    }
    if (rows.empty()) throw std::runtime_error("no rows for " + channel);
    return rows;
}

}  // namespace asip::test
