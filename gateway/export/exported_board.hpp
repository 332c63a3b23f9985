// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/items.hpp"
#include "asip/property/contact.hpp"
#include "asip/property/list.hpp"
#include "asip/property/value.hpp"

namespace asip::gateway::exports {

using property::is_reported;
using property::json_number;
using property::kFullBrightness;
using property::Kind;
using property::kMaxColor;
using property::Property;
using property::Request;

/// A board as dialects see it.
struct ExportedBoard {
    std::string board;  ///< its name on the bus
    std::string name;   ///< for people
    std::string chip;   ///< may be empty, as all below
    std::string sketch;
    std::string version;    ///< of the firmware
    std::string available;  ///< the newer one that its agent would load
    std::string room;
    std::vector<Property> properties;
    friend bool operator==(const ExportedBoard&, const ExportedBoard&) = default;

    /// By property::plain_id(). Null: it has none.
    const Property* property(std::string_view id) const {
        for (const auto& each : properties)
            if (property::plain_id(each.id) == id) return &each;
        return nullptr;
    }
};

/// `item`: with its whole description; nothing: it has none. `list`: its
/// properties, as its agent says; null: they are made here.
std::optional<ExportedBoard> exported_board(const bus::BoardItem& item, const std::vector<Property>* list,
                                            const property::FindModel& find_model);

/// What a document of one board may have at most, so that one board does not fill the broker or another
/// system.
inline constexpr std::size_t kMaxDocument = std::size_t{96} * 1024;
/// The board with as many of its properties, from the first, as a document of kMaxDocument has room for.
/// `bytes`: of the document of a board.
std::shared_ptr<const ExportedBoard> fitting(std::shared_ptr<const ExportedBoard> board,
                                             const std::function<std::size_t(const ExportedBoard&)>& bytes);

/// What is logged of a board of which so many properties are shown.
std::string left_out_text(std::string_view system, const ExportedBoard& whole, std::size_t shown);

/// What is shown of one property; a null value: it is not known.
struct Shown {
    std::size_t property = 0;  ///< its number
    nlohmann::json value;
};
/// What the report `text` of a service says of those of the board's properties (their numbers) that are read
/// there. `refused` counts values that they cannot have.
std::vector<Shown> reported_values(const ExportedBoard& board, const std::vector<std::size_t>& properties,
                                   std::string_view text, std::uint64_t& refused);
/// No ids are all of them.
inline bool is_one_of(const Property& property, const std::vector<std::string>& ids) {
    return ids.empty() || std::find(ids.begin(), ids.end(), property.id) != ids.end();
}
/// A light that is only on or off has none.
inline bool has_brightness(const Property& light) {
    return light.write && light.choices.empty();
}

}  // namespace asip::gateway::exports
