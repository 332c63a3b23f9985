// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace asip::text {

/// Reads the members of one JSON object strictly. The first fault of a document is kept with its place, as a
/// JSON pointer and a reason: "/parts/2/pin: is missing". After a fault each read gives its default, so that
/// callers need no branches; what they made of the document is then of no use.
///
///     std::string fault;
///     JsonReader reader(document, "", fault);
///     auto name = reader.text("name", "none");
///     auto count = reader.integer("count", 0, 65535);
///     reader.refuse_others();
///     if (!reader.ok()) return fail(fault);
class JsonReader {
  public:
    /// What a member that is `null` means.
    enum class Nulls {
        kFault,   ///< it has the wrong type
        kAbsent,  ///< the same as no such member
    };
    static constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);

    /// `place` is the JSON pointer of `object`, empty for the document itself. The readers of one document
    /// share `first_fault`, which is empty at first. `object` and `first_fault` must outlive the reader and
    /// every reader made by it. A fault if `object` is not an object.
    JsonReader(const nlohmann::json& object, std::string place, std::string& first_fault,
               Nulls nulls = Nulls::kFault);

    const nlohmann::json& value() const { return *object_; }
    const std::string& place() const { return place_; }
    /// Whether nothing was wrong so far in the whole document.
    bool ok() const { return first_fault_->empty(); }

    bool has(std::string_view key) { return find(key) != nullptr; }
    /// The member; null where it is absent.
    const nlohmann::json* find(std::string_view key);
    /// The same; a fault where it is absent.
    const nlohmann::json* required(std::string_view key);

    // Each returns its default, or nothing, for a member that is absent, and is a fault for one of another
    // type or out of bounds. Bounds are included.

    /// `max_bytes` counts bytes of UTF-8.
    std::string text(std::string_view key, std::string_view otherwise = {}, std::size_t max_bytes = kNoLimit);
    std::optional<std::uint64_t> integer(std::string_view key, std::uint64_t minimum, std::uint64_t maximum);
    double number(std::string_view key, double otherwise, double minimum, double maximum);
    bool flag(std::string_view key);
    /// A string, or an array of strings.
    std::vector<std::string> texts(std::string_view key, std::size_t max_items, std::size_t max_bytes);
    std::optional<JsonReader> object(std::string_view key);
    /// A reader for each item of an array; an item that is not an object is a fault.
    std::vector<JsonReader> list(std::string_view key, std::size_t max_items = kNoLimit);

    /// The members of an object, each with a reader; a member that is not an object itself is a fault.
    std::vector<std::pair<std::string, JsonReader>> members(std::string_view key);

    /// A fault for each member that was not asked for, with the nearest that was.
    void refuse_others();
    /// A fault of a member; of the object itself where `key` is empty.
    void fault(std::string_view key, std::string_view reason);
    /// A fault that names its place itself: "/parts/2/pin: reason".
    void fault_at(std::string fault);

  private:
    std::string place_of(std::string_view key) const;

    const nlohmann::json* object_;
    std::string place_;
    std::string* first_fault_;
    Nulls nulls_;
    std::vector<std::string> known_;
};

}  // namespace asip::text
