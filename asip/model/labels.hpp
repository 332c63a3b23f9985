// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/model/meaning.hpp"

namespace asip::text {
class JsonReader;
}

/// Labels by which boards are chosen ("room" = "lab"), and friendly names of services and pins. The board's
/// agent keeps them; they stand in its description as `labels` and `names`.
namespace asip::model {

inline constexpr std::size_t kMaxLabels = 32;         ///< of a board
inline constexpr std::size_t kMaxFriendlyNames = 64;  ///< services and pins of a board together
inline constexpr std::size_t kMaxLabelBytes = 63;     ///< of a key, of a value, of a friendly name
inline constexpr int kMaxLabelledPin = 255;

struct Labels {
    std::map<std::string, std::string> labels;    ///< by key; `name` is the board's friendly name
    std::map<std::string, std::string> services;  ///< friendly names by service
    std::map<int, std::string> pins;              ///< friendly names by digital pin
    Meanings meanings{};                          ///< what properties are, by their ids
    /// By digital pin: the mode that a command set last.
    std::map<int, int> modes{};

    bool empty() const { return *this == Labels(); }
    /// The name of a service or a pin; may be empty.
    std::string service(const std::string& name) const;
    std::string pin(int number) const;
    friend bool operator==(const Labels&, const Labels&) = default;
};

/// Values to set; nothing: removed.
struct LabelChange {
    using Value = std::optional<std::string>;
    std::map<std::string, Value> labels;
    std::map<std::string, Value> services;
    std::map<int, Value> pins;
    MeaningChanges meanings{};

    bool empty() const { return *this == LabelChange(); }
    friend bool operator==(const LabelChange&, const LabelChange&) = default;
};

/// Why a text cannot be a label's key, for a person; empty: it can. 1 to 63 of `A-Z a-z 0-9 . _ -`, letter or
/// digit at both ends; keys with `pin.` are names of pins.
std::string explain_label_key(std::string_view key);
/// The same of a value: UTF-8 of at most 63 bytes, no control characters, no blank at an end; may be empty.
std::string explain_label_value(std::string_view value);
/// The same of a friendly name, never empty.
std::string explain_friendly_name(std::string_view name);

/// Adds a person's words: `room=lab`, `room-` (remove it), `pin.13=status lamp`, `servo/name=left arm`. Fails
/// with what to write. With a `service`, only its `name` can be set.
Expected<void> add_assignment(LabelChange& change, std::string_view text, std::string_view service = {});

/// Fails beyond kMaxLabels or kMaxFriendlyNames.
Expected<Labels> changed(Labels labels, const LabelChange& change);

/// Writes the members `labels`, `names`, `meanings` and `pin_modes`; what is empty is left out.
void put_labels(nlohmann::json& object, const Labels& labels);
/// Faults: what the explain functions refuse, impossible names of services or pins, more than the bounds.
Labels read_labels(text::JsonReader& reader);
/// In this form `null` removes.
LabelChange read_label_change(text::JsonReader& reader);
nlohmann::json to_json(const LabelChange& change);

}  // namespace asip::model
