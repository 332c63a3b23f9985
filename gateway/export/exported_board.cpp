// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/exported_board.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {
namespace {

std::string label_of(const model::Description& description, const char* key) {
    const auto found = description.labels.labels.find(key);
    return found == description.labels.labels.end() ? std::string() : found->second;
}

}  // namespace

std::optional<ExportedBoard> exported_board(const bus::BoardItem& item, const std::vector<Property>* list,
                                            const property::FindModel& find_model) {
    if (item.description.empty()) return std::nullopt;
    const auto description = model::parse_description(item.description);
    if (!description) return std::nullopt;
    ExportedBoard board;
    board.board = item.board;
    board.name = label_of(*description, "name");
    board.room = label_of(*description, "room");
    board.chip = description->firmware.chip;
    board.sketch = description->firmware.sketch;
    board.version = description->firmware.version;
    board.available = description->firmware.available;
    board.properties = list != nullptr ? *list : property::properties_of(*description, find_model);
    return board;
}

std::shared_ptr<const ExportedBoard> fitting(std::shared_ptr<const ExportedBoard> board,
                                             const std::function<std::size_t(const ExportedBoard&)>& bytes) {
    for (auto size = bytes(*board); size > kMaxDocument && !board->properties.empty(); size = bytes(*board)) {
        auto shorter = *board;
        const auto count = shorter.properties.size();
        shorter.properties.resize(std::min(count - 1, count * kMaxDocument / size));
        board = std::make_shared<const ExportedBoard>(std::move(shorter));
    }
    return board;
}

std::string left_out_text(std::string_view system, const ExportedBoard& whole, std::size_t shown) {
    return "board " + whole.board + ": " + std::string(system) + " is shown " + std::to_string(shown) +
           " of " + std::to_string(whole.properties.size()) + " properties: a document has at most " +
           std::to_string(kMaxDocument / 1024) + " KiB";
}

std::vector<Shown> reported_values(const ExportedBoard& board, const std::vector<std::size_t>& properties,
                                   std::string_view text, std::uint64_t& refused) {
    std::vector<Shown> result;
    const auto published = model::parse_json(text);
    if (!published) return result;
    for (const auto index : properties) {
        const auto& property = board.properties[index];
        if (!is_reported(property)) continue;
        const auto* raw = property::raw_in(*property.read, *published);
        if (raw == nullptr) continue;
        if (auto value = property::value_of(property, *raw))
            result.push_back({index, std::move(*value)});
        else
            ++refused;
    }
    return result;
}

}  // namespace asip::gateway::exports
