#include "sim/json_reader.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "asip/text/nearest.hpp"

namespace asip::sim {

JsonReader::JsonReader(const nlohmann::json& object, std::string place, std::string& first_fault)
    : object_(&object), place_(std::move(place)), first_fault_(&first_fault) {
    if (!object.is_object()) fault("", "is not an object");
}

const nlohmann::json* JsonReader::find(const std::string& key) {
    known_.insert(key);
    if (!object_->is_object()) return nullptr;
    const auto found = object_->find(key);
    return found == object_->end() ? nullptr : &*found;
}

bool JsonReader::has(const std::string& key) {
    return find(key) != nullptr;
}

const nlohmann::json* JsonReader::required(const std::string& key) {
    const auto* value = find(key);
    if (value == nullptr) fault(key, "missing");
    return value;
}

std::string JsonReader::text(const std::string& key, const std::string& otherwise) {
    const auto* value = find(key);
    if (value == nullptr) return otherwise;
    if (value->is_string()) return value->get<std::string>();
    fault(key, "is not a string");
    return otherwise;
}

double JsonReader::number(const std::string& key, double otherwise, double minimum, double maximum) {
    const auto* value = find(key);
    if (value == nullptr) return otherwise;
    if (value->is_number() && value->get<double>() >= minimum && value->get<double>() <= maximum)
        return value->get<double>();
    fault(key, fmt::format("{} is not a number from {} to {}", value->dump(), minimum, maximum));
    return otherwise;
}

bool JsonReader::flag(const std::string& key) {
    const auto* value = find(key);
    if (value == nullptr) return false;
    if (value->is_boolean()) return value->get<bool>();
    fault(key, "is not true or false");
    return false;
}

std::vector<JsonReader> JsonReader::list(const std::string& key) {
    std::vector<JsonReader> readers;
    const auto* value = find(key);
    if (value == nullptr) return readers;
    if (!value->is_array()) fault(key, "is not a list");
    for (std::size_t i = 0; value->is_array() && i < value->size(); ++i)
        readers.emplace_back((*value)[i], fmt::format("{}{}[{}]", place_, key, i), *first_fault_);
    return readers;
}

void JsonReader::refuse_others() {
    if (!object_->is_object()) return;
    const std::vector<std::string> names(known_.begin(), known_.end());
    for (const auto& [key, value] : object_->items())
        if (known_.count(key) == 0) fault(key, "unknown" + text::did_you_mean(key, names));
}

void JsonReader::fault(const std::string& key, const std::string& reason) {
    if (!first_fault_->empty()) return;
    const bool needs_dot = !place_.empty() && !key.empty();
    const auto place = place_ + (needs_dot ? "." : "") + key;
    fault_at((place.empty() ? "the document" : place) + ": " + reason);
}

void JsonReader::fault_at(std::string fault) {
    if (first_fault_->empty()) *first_fault_ = std::move(fault);
}

}  // namespace asip::sim
