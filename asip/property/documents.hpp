// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/property/known_values.hpp"
#include "asip/property/property_json.hpp"

/// The retained documents by which an agent tells properties and values.
namespace asip::property {

inline constexpr int kDocumentVersion = 1;
inline constexpr std::size_t kMaxListBytes = std::size_t{128} * 1024;
inline constexpr std::size_t kMaxValuesBytes = std::size_t{32} * 1024;

/// The later session counts; within one the highest `seq`.
struct DocumentHead {
    std::string board;
    std::string session;
    std::uint64_t seq = 0;
    friend bool operator==(const DocumentHead&, const DocumentHead&) = default;
};

/// BOARD/$properties.
struct PropertyList {
    DocumentHead head;
    std::vector<Property> properties;
    friend bool operator==(const PropertyList&, const PropertyList&) = default;
};
std::string to_text(const PropertyList& list, Members members = Members::kNeeded);
/// From what anyone may have published. Fails with the first fault.
Expected<PropertyList> parse_list(std::string_view text);

/// In BOARD/$values.
struct ShownValue {
    nlohmann::json value{};
    How how = How::kNone;
    Unknown why = Unknown::kNever;
    double age = 0;                     ///< seconds since it was last said or set, when the document was made
    std::vector<ButtonEvent> events{};  ///< of a button, within the last second
    friend bool operator==(const ShownValue&, const ShownValue&) = default;
};

struct ValueDocument {
    DocumentHead head;
    std::string clock;  ///< the agent's clock when it was made, see bus::AgentClock
    std::map<std::string, ShownValue, std::less<>> values;  ///< by id of the property
    /// In an agent's answer: levels and analog values of all pins that it heard of, electrical:
    /// {"digital":{"2":1},"analog":{"0":320}}. Null: not asked for.
    nlohmann::json pins{};
    /// The same: properties of services.
    std::vector<Property> properties{};
    std::size_t left_out = 0;  ///< that did not fit
    /// How often within the session the board restarted, or came back: earlier reports do not count.
    std::uint64_t restarts = 0;
    friend bool operator==(const ValueDocument&, const ValueDocument&) = default;
};

/// The values of the services that `of` accepts. Values beyond kMaxValuesBytes are left out.
template <class Of>
ValueDocument values_of(const KnownValues& known, Time now, const Of& of);
ValueDocument values_of(const KnownValues& known, Time now);
std::string to_text(const ValueDocument& document, Members members = Members::kNeeded);
/// What was done with buttons, in the order of numbers, behind `last`, which becomes the highest.
std::vector<std::pair<std::string, ButtonAct>> new_acts(
    const std::map<std::string, ShownValue, std::less<>>& values, std::uint64_t& last);
Expected<ValueDocument> parse_values(std::string_view text);

// --- details

ShownValue shown(const Known& known, Time now, std::vector<ButtonEvent> events = {});

template <class Of>
ValueDocument values_of(const KnownValues& known, Time now, const Of& of) {
    ValueDocument document;
    const auto& properties = known.properties();
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].kind != Kind::kButton && of(properties[i].service))
            document.values.emplace(properties[i].id, shown(known.known(i), now, known.events(i, now)));
    return document;
}

}  // namespace asip::property
