// SPDX-License-Identifier: Apache-2.0
#include "asip/text/json_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::text {

using nlohmann::json;

namespace {

std::string decimal(double number) {
    std::array<char, 400> digits;
    const auto end = std::to_chars(digits.begin(), digits.end(), number, std::chars_format::fixed).ptr;
    return {digits.begin(), end};
}

}  // namespace

JsonReader::JsonReader(const json& object, std::string place, std::string& first_fault, Nulls nulls)
    : object_(&object), place_(std::move(place)), first_fault_(&first_fault), nulls_(nulls) {
    if (!object.is_object()) fault({}, "is not an object");
}

const json* JsonReader::find(std::string_view key) {
    auto known = std::find(known_.begin(), known_.end(), key);
    if (known == known_.end()) known = known_.emplace(known, key);
    if (!object_->is_object()) return nullptr;
    const auto found = object_->find(*known);
    if (found == object_->end() || (found->is_null() && nulls_ == Nulls::kAbsent)) return nullptr;
    return &*found;
}

const json* JsonReader::required(std::string_view key) {
    const auto* member = find(key);
    if (member == nullptr) fault(key, "is missing");
    return member;
}

std::string JsonReader::text(std::string_view key, std::string_view otherwise, std::size_t max_bytes) {
    const auto* member = find(key);
    if (member == nullptr) return std::string(otherwise);
    if (!member->is_string())
        fault(key, "is not a string");
    else if (const auto& value = member->get_ref<const std::string&>(); value.size() > max_bytes)
        fault(key, "is longer than " + std::to_string(max_bytes) + " bytes");
    else
        return value;
    return std::string(otherwise);
}

std::optional<std::uint64_t> JsonReader::integer(std::string_view key, std::uint64_t minimum,
                                                 std::uint64_t maximum) {
    const auto* member = find(key);
    if (member == nullptr) return std::nullopt;
    const bool negative =
        member->is_number_integer() && !member->is_number_unsigned() && member->get<std::int64_t>() < 0;
    if (!member->is_number_integer())
        fault(key, "is not an integer");
    else if (negative || member->get<std::uint64_t>() < minimum)
        fault(key, member->dump() + " is below " + std::to_string(minimum));
    else if (member->get<std::uint64_t>() > maximum)
        fault(key, member->dump() + " is above " + std::to_string(maximum));
    else
        return member->get<std::uint64_t>();
    return std::nullopt;
}

double JsonReader::number(std::string_view key, double otherwise, double minimum, double maximum) {
    const auto* member = find(key);
    if (member == nullptr) return otherwise;
    if (member->is_number() && member->get<double>() >= minimum && member->get<double>() <= maximum)
        return member->get<double>();
    fault(key, printable(member->dump(-1, ' ', false, json::error_handler_t::replace)) +
                   " is not a number from " + decimal(minimum) + " to " + decimal(maximum));
    return otherwise;
}

bool JsonReader::flag(std::string_view key) {
    const auto* member = find(key);
    if (member == nullptr) return false;
    if (member->is_boolean()) return member->get<bool>();
    fault(key, "is not true or false");
    return false;
}

std::vector<std::string> JsonReader::texts(std::string_view key, std::size_t max_items,
                                           std::size_t max_bytes) {
    const auto* member = find(key);
    if (member == nullptr) return {};
    const auto fits = [max_bytes](const json& item) {
        return item.is_string() && item.get_ref<const std::string&>().size() <= max_bytes;
    };
    if (fits(*member)) return {member->get<std::string>()};
    if (member->is_array() && member->size() <= max_items &&
        std::all_of(member->begin(), member->end(), fits))
        return member->get<std::vector<std::string>>();
    fault(key, "is not a string or an array of at most " + std::to_string(max_items) +
                   " strings, each of at most " + std::to_string(max_bytes) + " bytes");
    return {};
}

std::optional<JsonReader> JsonReader::object(std::string_view key) {
    const auto* member = find(key);
    if (member == nullptr) return std::nullopt;
    JsonReader inner(*member, place_of(key), *first_fault_, nulls_);
    if (!member->is_object()) return std::nullopt;
    return inner;
}

std::vector<JsonReader> JsonReader::list(std::string_view key, std::size_t max_items) {
    std::vector<JsonReader> readers;
    const auto* member = find(key);
    if (member == nullptr) return readers;
    if (!member->is_array()) {
        fault(key, "is not an array");
        return readers;
    }
    if (member->size() > max_items) {
        fault(key, "has more than " + std::to_string(max_items) + " items");
        return readers;
    }
    const auto place = place_of(key) + "/";
    readers.reserve(member->size());
    for (std::size_t i = 0; i < member->size(); ++i)
        readers.emplace_back((*member)[i], place + std::to_string(i), *first_fault_, nulls_);
    return readers;
}

std::vector<std::pair<std::string, JsonReader>> JsonReader::members(std::string_view key) {
    std::vector<std::pair<std::string, JsonReader>> readers;
    const auto outer = object(key);
    if (!outer) return readers;
    for (const auto& [name, member] : outer->value().items())
        readers.emplace_back(name, JsonReader(member, outer->place_of(name), *first_fault_, nulls_));
    return readers;
}

void JsonReader::refuse_others() {
    if (!object_->is_object()) return;
    for (const auto& [key, value] : object_->items())
        if (std::find(known_.begin(), known_.end(), key) == known_.end())
            fault(key, "is unknown" + did_you_mean(key, known_));
}

void JsonReader::fault(std::string_view key, std::string_view reason) {
    if (first_fault_->empty()) fault_at(place_of(key) + ": " + std::string(reason));
}

void JsonReader::fault_at(std::string fault) {
    if (first_fault_->empty()) *first_fault_ = std::move(fault);
}

std::string JsonReader::place_of(std::string_view key) const {
    if (key.empty()) return place_.empty() ? "/" : place_;
    return place_ + "/" + printable(key);
}

}  // namespace asip::text
