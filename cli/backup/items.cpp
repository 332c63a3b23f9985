// SPDX-License-Identifier: Apache-2.0
#include "cli/backup/items.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "asip/model/names.hpp"
#include "cli/backup/sealed.hpp"

namespace asip::cli {
namespace {

using Levels = std::vector<std::string_view>;

constexpr std::array<std::string_view, 4> kPlaceWords{"etc", "mosquitto", "state", "dashboard"};
constexpr std::size_t kMaxLevels = 4, kMaxNameBytes = 200;
constexpr mode_t kModesKept = 0644, kEverybodyReads = 004;
constexpr std::string_view kJsonEnding = ".json";

Levels path_levels(std::string_view path) {
    Levels levels;
    for (std::size_t at = 0; at <= path.size();) {
        const auto slash = std::min(path.find('/', at), path.size());
        levels.push_back(path.substr(at, slash - at));
        at = slash + 1;
    }
    return levels;
}

bool is_name(std::string_view name) {
    return !name.empty() && name.size() <= kMaxNameBytes && name.front() != '.' &&
           std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

bool is_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Beside what asipctl secure made, the broker keeps in bus/broker what it retains.
bool valid_in_etc(const Levels& levels) {
    if (levels.back().ends_with(".new") || levels.back() == "unfinished") return false;
    if (levels.size() < 2 || levels[0] != "bus" || levels[1] != "broker") return true;
    return levels.size() == 3 && is_of(levels[2], {"passwords", "rules.acl", "broker.crt", "broker.key"});
}

bool valid_in_state(const Levels& levels) {
    if (levels.size() == 1) return is_of(levels[0], {"history.db", "history.values.db"});
    if (!levels.back().ends_with(kJsonEnding)) return false;
    return levels.size() == 2 ? is_of(levels[0], {"labels", "stopped"})
                              : levels.size() == 3 && levels[0] == "links";
}

}  // namespace

bool BackupItem::is_secret() const {
    return place == Place::kEtc && (closed || path.starts_with("bus/") || path.starts_with("credentials/") ||
                                    (mode & kEverybodyReads) == 0);
}

bool BackupItem::is_database() const {
    return place == Place::kState && path.ends_with(".db");
}

bool BackupItem::valid() const {
    const auto levels = path_levels(path);
    if (levels.size() > kMaxLevels || !std::all_of(levels.begin(), levels.end(), is_name)) return false;
    if ((mode & ~kModesKept) != 0 || size > (is_database() ? kMaxBackupBytes : kMaxFileBytes)) return false;
    switch (place) {
        case Place::kEtc:
            return valid_in_etc(levels);
        case Place::kMosquitto:
            return is_of(path, {"asip.conf", "asip-secured.conf"});
        case Place::kState:
            return valid_in_state(levels);
        case Place::kDashboard:
            return model::valid_name(path);
    }
    return false;
}

std::string to_text(const std::string& about, const std::vector<BackupItem>& items) {
    auto text = about + "\n";
    for (const auto& item : items)
        text += fmt::format("{} {} {} {} {}\n", kPlaceWords.at(static_cast<std::size_t>(item.place)),
                            item.mode, item.changed, item.size, item.path);
    return text + "\n";
}

Outcome<BackupList> read_list(const std::string& begin, std::uint64_t bytes, bool sealed) {
    const auto wrong = failure(program::kExitFailure, "the list of the backup cannot be read");
    const auto end = begin.find("\n\n");
    if (end == std::string::npos) return wrong;
    std::istringstream lines(begin.substr(0, end + 1));
    BackupList list;
    std::set<std::pair<Place, std::string>> seen;
    std::uint64_t at = end + 2;
    std::getline(lines, list.about);
    for (std::string line, place; std::getline(lines, line);) {
        std::istringstream words(line);
        BackupItem item;
        if (!(words >> place >> item.mode >> item.changed >> item.size) || words.get() != ' ') return wrong;
        std::getline(words, item.path);
        const auto known = std::find(kPlaceWords.begin(), kPlaceWords.end(), place);
        item.place = static_cast<Place>(known - kPlaceWords.begin());
        item.at = at;
        if (known == kPlaceWords.end() || !item.valid() || (item.is_secret() && !sealed) ||
            item.changed < 0 || item.size > bytes - at || list.items.size() == kMaxItems ||
            !seen.insert({item.place, item.path}).second)
            return wrong;
        at += item.size;
        list.items.push_back(std::move(item));
    }
    if (at != bytes) return wrong;
    return list;
}

}  // namespace asip::cli
