// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catalogue_check.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "asip/catalogue/catalogue_impl.hpp"
#include "asip/model/names.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::catalogue {
namespace {

template <class Part>
bool counts_agree(const PartPool<Part>& pool, const std::vector<const Part*>& used) {
    const std::set<const Part*> distinct(used.begin(), used.end());
    for (const Part* part : distinct) {
        const auto references = static_cast<std::size_t>(std::count(used.begin(), used.end(), part));
        if (part->references != references || pool.find(part->text) != part) return false;
    }
    return distinct.size() == pool.size();
}

}  // namespace

std::string CatalogueCheck::check(const Catalogue& catalogue) {
    const auto& all = *catalogue.impl_;
    std::vector<std::uint32_t> slots;
    for (std::uint32_t slot = 0; slot < all.slots_; ++slot)
        if (all.board(slot).in_use) slots.push_back(slot);
    std::sort(slots.begin(), slots.end(),
              [&all](auto a, auto b) { return all.board(a).name < all.board(b).name; });
    if (slots.size() != all.names_.size()) return "names counted wrong";
    if (slots.size() != all.wheel_.size()) return "boards without a due time, or due times without a board";

    std::vector<const FirmwarePart*> firmwares;
    std::vector<const PinsPart*> pins;
    std::vector<const ServicesPart*> services;
    std::array<std::vector<std::uint32_t>, kStates> by_state;
    std::size_t conflicts = 0;
    for (const std::uint32_t slot : slots) {
        const Board& b = all.board(slot);
        if (all.slot_of(b.name) != slot) return b.name + ": not found by its name";
        if (!model::valid_board_name(b.name)) return b.name + ": invalid name";
        if (b.effective != b.reported && b.effective != model::BoardState::kLost)
            return b.name + ": a state that no message reported";
        if (b.described == b.session.empty())
            return b.name + ": description without session, or the other way";
        const auto due = all.wheel_.due(slot);
        if (model::is_there(b.effective) && (!due || *due > b.deadline))
            return b.name + ": lease would be missed";
        by_state[index_of(b.effective)].push_back(slot);
        if (b.firmware != nullptr) firmwares.push_back(b.firmware);
        if (b.pins != nullptr) pins.push_back(b.pins);
        if (b.services != nullptr) services.push_back(b.services);
        if (b.conflict() != nullptr) ++conflicts;
        if (b.uncommon && b.uncommon->old_sessions.size() > UncommonBoardData::kOldSessions)
            return b.name + ": too many old sessions";
    }
    if (conflicts != all.stats_.conflicts) return "conflicts counted wrong";
    if (!counts_agree(all.firmwares_, firmwares) || !counts_agree(all.pins_, pins) ||
        !counts_agree(all.services_, services)) {
        return "parts and the boards that refer to them disagree";
    }
    for (std::size_t state = 0; state < kStates; ++state)
        if (all.all_[state].size() != by_state[state].size()) return "boards by state counted wrong";
    if (!all.order_.settled()) return {};
    for (std::size_t state = 0; state < kStates; ++state) {
        std::vector<std::uint32_t> listed;
        all.all_[state].list().for_each([&](std::uint32_t slot) { listed.push_back(slot); });
        if (all.all_[state].settled() && listed != by_state[state]) return "boards by state listed wrong";
    }
    for (const auto& [name, of_kind] : all.kinds_.all()) {
        const Kind* const kind = of_kind.get();
        for (std::size_t state = 0; state < kStates; ++state) {
            std::vector<std::uint32_t> expected;
            std::size_t count = 0;
            for (const std::uint32_t slot : by_state[state]) {
                const ServicesPart* part = all.board(slot).services;
                if (part == nullptr) continue;
                const auto here = std::count_if(part->services.begin(), part->services.end(),
                                                [kind](const Service& s) { return s.kind == kind; });
                if (here > 0) expected.push_back(slot);
                count += static_cast<std::size_t>(here);
            }
            std::vector<std::uint32_t> listed;
            kind->boards[state].list().for_each([&](std::uint32_t slot) { listed.push_back(slot); });
            if (count != kind->services[state]) return name + ": services counted wrong";
            if (kind->boards[state].settled() && listed != expected) return name + ": boards listed wrong";
        }
    }
    return {};
}

std::string CatalogueCheck::fingerprint(const Catalogue& catalogue) {
    const auto& all = *catalogue.impl_;
    std::vector<std::string> lines;
    const Instant now{Time{}, text::WallTime{}};
    for (std::uint32_t slot = 0; slot < all.slots_; ++slot) {
        const Board& b = all.board(slot);
        if (!b.in_use) continue;
        std::string line = b.name + " " + std::string(model::to_text(b.effective)) + " " +
                           std::string(model::to_text(b.reported)) + (b.names_only ? " names-only " : " ") +
                           all.board_item(b, now, true).description;
        if (!b.described && b.services != nullptr) line += b.services->text;
        if (b.conflict() != nullptr) line += " conflict with " + b.conflict()->session;
        lines.push_back(std::move(line));
    }
    std::sort(lines.begin(), lines.end());
    std::string text;
    for (const std::string& line : lines)
        text += line + "\n";
    return text;
}

}  // namespace asip::catalogue
