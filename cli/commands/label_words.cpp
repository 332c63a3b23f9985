// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/label_words.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

namespace asip::cli {

std::string property_in(std::string& text) {
    const auto board = text.find('/');
    if (board == std::string::npos || text.find('/', board + 1) == std::string::npos) return {};
    auto id = text.substr(board + 1);
    text.resize(board);
    return id;
}

Expected<void> add_meanings(model::LabelChange& change, const std::string& id,
                            const std::vector<std::string>& words) {
    for (const auto& word : words) {
        const auto added = model::add_meaning(change.meanings, id, word);
        if (!added) return fail(added.error());
        if (!*added)
            return fail(word +
                        ": of a property these can be given: class, inverted, debounce, unit, line, icon, "
                        "hidden; names are given to pins, asipctl label BOARD pin.A0=NAME, and services");
    }
    return {};
}

PinNames take_pin_names(std::vector<std::string>& words) {
    static constexpr std::string_view kPin = "pin.";
    PinNames names;
    std::erase_if(words, [&names](const std::string& word) {
        const auto equals = word.find('=');
        const bool removes = equals == std::string::npos && word.ends_with('-');
        if (!word.starts_with(kPin) || (equals == std::string::npos && !removes)) return false;
        const auto end = removes ? word.size() - 1 : equals;
        auto pin = word.substr(kPin.size(), end - kPin.size());
        if (pin.find_first_not_of("0123456789") == std::string::npos) return false;
        names[std::move(pin)] = removes ? std::nullopt : std::optional(word.substr(equals + 1));
        return true;
    });
    return names;
}

void add_rows(Table& table, const std::string& board, const model::Labels& labels) {
    for (const auto& [key, value] : labels.labels)
        table.add({board, key, value});
    for (const auto& [service, name] : labels.services)
        table.add({board + "/" + service, "name", name});
    for (const auto& [pin, name] : labels.pins)
        table.add({board, "pin." + std::to_string(pin), name});
    for (const auto& [id, meaning] : labels.meanings) {
        const auto members = model::to_json(meaning);
        for (const auto& [key, value] : members.items())
            table.add({board + "/" + id, key, value.is_string() ? value.get<std::string>() : value.dump()});
    }
}

}  // namespace asip::cli
