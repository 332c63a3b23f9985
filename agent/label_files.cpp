// SPDX-License-Identifier: Apache-2.0
#include "agent/label_files.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/program/kept_file.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::agent {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFileBytes = 64 * 1024;

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
    errno = 0;
    std::ifstream stream(path, std::ios::binary);
    if (!stream && (errno == ENOENT || errno == ENOTDIR)) return model::Labels();
    const auto unreadable = [&path](const std::string& why) {
        return fail(path.string() + ": " + why + "; mend or remove it, and start the agent again");
    };
    if (!stream) return unreadable(std::strerror(errno));
    std::string text(kMaxFileBytes + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (stream.bad()) return unreadable("cannot be read");
    text.resize(static_cast<std::size_t>(stream.gcount()));
    const auto document = model::parse_json(text, {.max_bytes = kMaxFileBytes, .max_depth = 8});
    if (!document) return unreadable(document.error());
    std::string fault;
    text::JsonReader reader(*document, "", fault);
    auto labels = model::read_labels(reader);
    if (!reader.ok()) return unreadable(fault);
    return labels;
}

Expected<void> LabelFiles::save(const std::string& board, const model::Labels& labels) const {
    if (folder_.empty())
        return fail("the agent has no folder to keep labels in; start it with --state-dir DIR");
    auto document = nlohmann::json::object();
    model::put_labels(document, labels);
    return program::keep_file(file(board), model::dump_json_pretty(document) + "\n");
}

}  // namespace asip::agent
