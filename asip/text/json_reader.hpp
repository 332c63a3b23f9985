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
    /// What `null` means.
    enum class Nulls {
        kFault,   ///< it has the wrong type
        kAbsent,  ///< the same as no such member
    };
    static constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);

    /// `place`: the JSON pointer of `object`. The readers of a document share `first_fault`, which begins
    /// empty; both must outlive them. A fault if `object` is no object.
    JsonReader(const nlohmann::json& object, std::string place, std::string& first_fault,
               Nulls nulls = Nulls::kFault);

    const nlohmann::json& value() const { return *object_; }
    const std::string& place() const { return place_; }
    /// In the whole document.
    bool ok() const { return first_fault_->empty(); }

    bool has(std::string_view key) { return find(key) != nullptr; }
    /// Null: absent.
    const nlohmann::json* find(std::string_view key);
    /// A fault where it is absent.
    const nlohmann::json* required(std::string_view key);

    // Each returns its default, or nothing, for a member that is absent, and is a fault for one of another
    // type or out of bounds. Bounds are included.

    /// `max_bytes`: of UTF-8.
    std::string text(std::string_view key, std::string_view otherwise = {}, std::size_t max_bytes = kNoLimit);
    std::optional<std::uint64_t> integer(std::string_view key, std::uint64_t minimum, std::uint64_t maximum);
    double number(std::string_view key, double otherwise, double minimum, double maximum);
    bool flag(std::string_view key);
    /// A string, or an array of strings.
    std::vector<std::string> texts(std::string_view key, std::size_t max_items, std::size_t max_bytes);
    std::optional<JsonReader> object(std::string_view key);
    /// For each item of an array of objects.
    std::vector<JsonReader> list(std::string_view key, std::size_t max_items = kNoLimit);

    /// For each member that is an object.
    std::vector<std::pair<std::string, JsonReader>> members(std::string_view key);

    /// A fault for each member that was not asked for, with the nearest that was.
    void refuse_others();
    /// Empty `key`: of the object itself.
    void fault(std::string_view key, std::string_view reason);
    /// With its own place: "/parts/2/pin: reason".
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
