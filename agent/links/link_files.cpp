// SPDX-License-Identifier: Apache-2.0
#include "agent/links/link_files.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/program/kept_file.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::agent {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Indented, each number of a command has a line of its own.
constexpr std::size_t kMaxLinkFileBytes = 32 * links::kMaxLinkBytes;
constexpr std::size_t kMaxFaults = 20;
constexpr const char* kKept = "kept";

Expected<KeptLink> read_file(const fs::path& path) {
    const auto text = program::read_kept_file(path, kMaxLinkFileBytes);
    if (!text) return fail(text.error());
    auto document = model::parse_json(text->value_or(""), {.max_bytes = kMaxLinkFileBytes, .max_depth = 16});
    if (!document) return fail(document.error());
    auto state = json::object();
    if (const auto found = document->find(kKept); document->is_object() && found != document->end()) {
        state = *found;
        document->erase(found);
    }
    auto link = links::read_link(*document);
    if (!link) return fail(link.error());
    if (path.stem() != link->name) return fail("is of another link: " + link->name);
    std::string fault;
    text::JsonReader reader(state, "/kept", fault);
    KeptLink kept{std::move(*link), {}};
    if (const auto* seen = reader.find("seen"); seen != nullptr && !seen->is_structured())
        kept.kept.seen = *seen;
    kept.kept.suspended = reader.flag("suspended");
    kept.kept.over = reader.flag("over");
    if (!reader.ok()) return fail(fault);
    return kept;
}

}  // namespace

std::string to_text(const KeptLink& link) {
    auto document = links::to_json(link.link);
    auto& state = document[kKept] = json::object();
    if (!link.kept.seen.is_null()) state["seen"] = link.kept.seen;
    if (link.kept.suspended) state["suspended"] = true;
    if (link.kept.over) state["over"] = true;
    return model::dump_json_pretty(document) + "\n";
}

LinkFiles::Loaded LinkFiles::load(const std::string& board) const {
    Loaded loaded;
    if (folder_.empty()) return loaded;
    std::error_code error;
    std::vector<fs::path> files;
    for (fs::directory_iterator each(folder_ / "links" / board, error), end; !error && each != end;
         each.increment(error))
        if (each->path().extension() == ".json") files.push_back(each->path());
    for (const auto& file : files) {
        auto link = read_file(file);
        if (link && loaded.links.size() < links::kMaxLinks) {
            loaded.links.push_back(std::move(*link));
            continue;
        }
        auto aside = file;
        aside += ".damaged";
        fs::rename(file, aside, error);
        if (loaded.faults.size() >= kMaxFaults) continue;
        loaded.faults.push_back({(error ? file : aside).filename().string(),
                                 file.string() + ": " + (link ? "is one too many" : link.error()) +
                                     (error ? "" : "; it is now " + aside.string())});
    }
    return loaded;
}

Expected<void> LinkFiles::save(const std::string& board, const std::string& name,
                               const std::string& text) const {
    if (folder_.empty())
        return fail("the agent has no folder to keep links in; start it with --state-dir DIR");
    const auto path = folder_ / "links" / board / (name + ".json");
    if (!text.empty()) return program::keep_file(path, text);
    return program::drop_file(path);
}

}  // namespace asip::agent
