// SPDX-License-Identifier: Apache-2.0
#include "agent/describe/label_files.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/program/kept_file.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::agent {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFileBytes = 64 * 1024;
constexpr int kMaxSetAside = 9;

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? std::string() : value;
}

}  // namespace

fs::path default_state_folder() {
    if (const auto folders = variable("STATE_DIRECTORY"); !folders.empty())
        return folders.substr(0, folders.find(':'));
    if (const auto folder = variable("XDG_STATE_HOME"); folder.starts_with('/'))
        return fs::path(folder) / "asip";
    if (const auto home = variable("HOME"); home.starts_with('/'))
        return fs::path(home) / ".local/state/asip";
    return {};
}

fs::path LabelFiles::file(const std::string& board) const {
    return folder_ / "labels" / (board + ".json");
}

Expected<model::Labels> LabelFiles::load(const std::string& board) const {
    if (folder_.empty()) return model::Labels();
    const auto path = file(board);
    const auto unreadable = [](const std::string& why) {
        return fail(why +
                    "; mend it and start the agent again, or set labels anew (this file is then put aside)");
    };
    const auto text = program::read_kept_file(path, kMaxFileBytes);
    if (!text) return unreadable(text.error());
    if (!*text) return model::Labels();
    const auto document = model::parse_json(**text, {.max_bytes = kMaxFileBytes, .max_depth = 8});
    if (!document) return unreadable(path.string() + ": " + document.error());
    std::string fault;
    text::JsonReader reader(*document, "", fault);
    auto labels = model::read_labels(reader);
    if (!reader.ok()) return unreadable(path.string() + ": " + fault);
    return labels;
}

Expected<fs::path> LabelFiles::set_aside(const std::string& board, bool unknown) const {
    if (const auto there = load(board); there && (!unknown || there->empty())) return fs::path();
    const auto damaged = file(board);
    for (int number = 1; number <= kMaxSetAside; ++number) {
        auto aside = damaged;
        aside += number == 1 ? ".damaged" : ".damaged-" + std::to_string(number);
        std::error_code error;
        if (fs::exists(fs::symlink_status(aside, error))) continue;
        fs::rename(damaged, aside, error);
        if (error)
            return fail(damaged.string() + " cannot be read, nor put aside as " + aside.string() + ": " +
                        error.message());
        return aside;
    }
    return fail(damaged.string() + " cannot be read, and " + std::to_string(kMaxSetAside) +
                " others like it were put aside beside it: mend or remove them");
}

Expected<fs::path> LabelFiles::save(const std::string& board, const LabelsToKeep& keep) const {
    if (folder_.empty())
        return fail("the agent has no folder to keep labels in; start it with --state-dir DIR");
    auto document = nlohmann::json::object();
    model::put_labels(document, keep.labels);
    auto aside = set_aside(board, keep.unknown_before);
    if (!aside) return aside;
    if (const auto kept = program::keep_file(file(board), model::dump_json_pretty(document) + "\n"); !kept)
        return fail(kept.error());
    return aside;
}

}  // namespace asip::agent
