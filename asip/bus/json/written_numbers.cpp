// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/json/written_numbers.hpp"

#include <nlohmann/json.hpp>
#include <string>

#include "asip/bus/json/json_scanner.hpp"

namespace asip::bus {

std::string_view written_member(std::string_view payload, std::string_view name) {
    JsonScanner scanner(payload);
    std::string_view found;
    std::string_view key;
    if (!scanner.enter_object()) return {};
    while (scanner.next_member(key)) {
        const bool wanted = key == name;
        std::string_view value;
        if (!scanner.value(value)) break;
        if (wanted) found = value;
    }
    return found;
}

void keep_numbers(std::string_view payload, nlohmann::json& object,
                  std::initializer_list<std::string_view> names) {
    for (const auto name : names) {
        const auto member = object.find(name);
        if (member == object.end() || !member->is_number_float()) continue;
        if (const auto written = written_member(payload, name); !written.empty())
            *member = std::string(written);
    }
}

}  // namespace asip::bus
