// SPDX-License-Identifier: Apache-2.0
#include "agent/safety/stop_files.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/program/kept_file.hpp"

namespace asip::agent {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxStopFileBytes = 4096;

}  // namespace

fs::path StopFiles::file(const std::string& board) const {
    return folder_ / "stopped" / (board + ".json");
}

Expected<std::optional<model::StopInfo>> StopFiles::load(const std::string& board) const {
    if (folder_.empty()) return std::optional<model::StopInfo>();
    const auto path = file(board);
    const auto text = program::read_kept_file(path, kMaxStopFileBytes);
    if (!text) return fail(text.error());
    if (!*text) return std::optional<model::StopInfo>();
    const auto document = model::parse_json(**text, {.max_bytes = kMaxStopFileBytes, .max_depth = 4});
    if (!document || !document->is_object())
        return fail(path.string() + ": " + (document ? "is no object" : document.error()));
    const auto member = [&](const char* name) {
        const auto found = document->find(name);
        return found != document->end() && found->is_string() ? found->get<std::string>() : std::string();
    };
    return std::optional(model::StopInfo{member("by"), member("why"), member("since")});
}

Expected<void> StopFiles::save(const std::string& board,
                               const std::optional<model::StopInfo>& stopped) const {
    if (folder_.empty())
        return fail("the agent has no folder to keep a stop in; start it with --state-dir DIR");
    const auto path = file(board);
    if (!stopped) {
        std::error_code error;
        fs::remove(path, error);
        if (error) return fail(path.string() + ": " + error.message());
        return {};
    }
    const nlohmann::json document{{"by", stopped->by}, {"why", stopped->why}, {"since", stopped->since}};
    return program::keep_file(path, model::dump_json_pretty(document) + "\n");
}

}  // namespace asip::agent
