// SPDX-License-Identifier: Apache-2.0
#include "asip/model/meaning.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "asip/model/json.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using text::JsonReader;

constexpr std::size_t kMaxWordBytes = 63;
constexpr double kMaxPoint = 1e9;

std::vector<std::string> class_words() {
    std::vector<std::string> words;
    for (const auto& [word, use] : meaning_classes())
        words.push_back(word);
    return words;
}

std::string class_fault(const std::string& word) {
    const auto words = class_words();
    std::string text =
        "there is no class \"" + text::printable(word) + "\"" + text::did_you_mean(word, words);
    if (text.ends_with('"')) {
        text += "; there are";
        for (const auto& each : words)
            text += " " + each;
    }
    return text;
}

bool is_id(std::string_view id) {
    const auto allowed = [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' ||
               c == '_' || c == '-' || c == '/';
    };
    return !id.empty() && id.size() <= kMaxPropertyIdBytes && !id.starts_with('/') && !id.ends_with('/') &&
           id.find("//") == std::string_view::npos && std::all_of(id.begin(), id.end(), allowed);
}

std::string read_word(JsonReader& reader, const char* key) {
    auto word = reader.text(key, {}, kMaxWordBytes);
    if (!text::is_showable(word)) reader.fault(key, "holds control characters");
    return word;
}

std::optional<bool> read_flag(JsonReader& reader, const char* key) {
    const auto* member = reader.find(key);
    if (member == nullptr) return std::nullopt;
    return reader.flag(key);
}

std::optional<std::array<double, 4>> read_line(JsonReader& reader) {
    const auto* member = reader.find("line");
    if (member == nullptr) return std::nullopt;
    std::array<double, 4> line{};
    bool good = member->is_array() && member->size() == line.size();
    for (std::size_t i = 0; good && i < line.size(); ++i) {
        good = (*member)[i].is_number();
        if (good) line[i] = (*member)[i].get<double>();
        good = good && std::isfinite(line[i]) && std::abs(line[i]) <= kMaxPoint;
    }
    if (!good || line[0] == line[1]) {
        reader.fault("line", "is not [RAW, RAW, VALUE, VALUE] with two different RAW");
        return std::nullopt;
    }
    return line;
}

std::optional<bool> truth_of(std::string_view text) {
    if (text == "yes" || text == "true" || text == "1" || text == "on") return true;
    if (text == "no" || text == "false" || text == "0" || text == "off") return false;
    return std::nullopt;
}

std::optional<std::vector<double>> numbers_of(std::string text) {
    std::vector<double> numbers;
    const char* at = text.c_str();
    for (;;) {
        char* end = nullptr;
        numbers.push_back(std::strtod(at, &end));
        if (end == at || !std::isfinite(numbers.back())) return std::nullopt;
        if (*end == '\0') return numbers;
        if (*end != ':') return std::nullopt;
        at = end + 1;
    }
}

/// The JSON of a value that a person wrote; nothing: it cannot be.
std::optional<json> written(std::string_view key, std::string_view value) {
    const std::string text(value);
    if (key == "inverted" || key == "hidden") {
        const auto truth = truth_of(value);
        return truth ? std::optional<json>(*truth) : std::nullopt;
    }
    if (key == "debounce") {
        const auto numbers = numbers_of(value.ends_with("ms") ? text.substr(0, text.size() - 2) : text);
        if (!numbers || numbers->size() != 1 || std::floor(numbers->front()) != numbers->front())
            return std::nullopt;
        return static_cast<std::int64_t>(numbers->front());
    }
    if (key == "line") {
        const auto numbers = numbers_of(text);
        if (!numbers || numbers->size() != 4) return std::nullopt;
        return json(*numbers);
    }
    return json(text);
}

std::string_view usage_of(std::string_view key) {
    if (key == "inverted" || key == "hidden") return "yes or no";
    if (key == "debounce") return "milliseconds, 0 to 1000";
    if (key == "line") return "RAW:RAW:VALUE:VALUE, such as 0:1023:0:100";
    return "a text of at most 63 bytes";
}

bool is_member(std::string_view key) {
    for (const auto* known : {"class", "inverted", "debounce", "unit", "line", "icon", "hidden"})
        if (key == known) return true;
    return false;
}

/// What is wrong with the members of a change; empty: nothing.
std::string members_fault(const json& members) {
    json given = json::object();
    for (const auto& [key, value] : members.items()) {
        if (!is_member(key)) return key + ": a meaning has no such member";
        if (!value.is_null()) given[key] = value;
    }
    std::string fault;
    JsonReader reader(given, "", fault);
    read_meaning(reader);
    return fault;
}

std::string bounds_fault(const Meanings& meanings) {
    if (meanings.size() > kMaxMeanings)
        return "a board has at most " + std::to_string(kMaxMeanings) + " meanings; remove one first";
    json object = json::object();
    put_meanings(object, meanings);
    if (dump_json(object).size() > kMaxMeaningsBytes)
        return "the meanings of a board have at most " + std::to_string(kMaxMeaningsBytes) + " bytes";
    return {};
}

}  // namespace

const std::vector<std::pair<std::string, ClassUse>>& meaning_classes() {
    static const std::vector<std::pair<std::string, ClassUse>> classes{
        {"button", ClassUse::kInput},    {"door", ClassUse::kInput},
        {"window", ClassUse::kInput},    {"motion", ClassUse::kInput},
        {"occupancy", ClassUse::kInput}, {"moisture", ClassUse::kInput},
        {"smoke", ClassUse::kInput},     {"vibration", ClassUse::kInput},
        {"light", ClassUse::kOutput},    {"plug", ClassUse::kOutput},
        {"relay", ClassUse::kOutput},    {"fan", ClassUse::kOutput},
        {"pump", ClassUse::kOutput},     {"heater", ClassUse::kOutput},
        {"buzzer", ClassUse::kOutput},   {"temperature", ClassUse::kNumber},
        {"humidity", ClassUse::kNumber}, {"illuminance", ClassUse::kNumber},
        {"voltage", ClassUse::kNumber},  {"battery", ClassUse::kNumber},
        {"energy", ClassUse::kNumber},   {"level", ClassUse::kNumber}};
    return classes;
}

std::optional<ClassUse> use_of_class(std::string_view name) {
    for (const auto& [word, use] : meaning_classes())
        if (word == name) return use;
    return std::nullopt;
}

Expected<bool> add_meaning(MeaningChanges& changes, const std::string& id, std::string_view text) {
    const auto equals = text.find('=');
    const bool removes = equals == std::string_view::npos && text.ends_with('-');
    const auto key = text.substr(0, removes ? text.size() - 1 : equals);
    if (!is_member(key)) return false;
    if (!is_id(id)) return fail("\"" + text::printable(id) + "\" is no property; write SERVICE/ELEMENT/NAME");
    if (!removes && equals == std::string_view::npos)
        return fail(std::string(key) + ": write " + std::string(key) + "=VALUE, or " + std::string(key) +
                    "- to remove it");
    auto value = removes ? std::optional<json>(json()) : written(key, text.substr(equals + 1));
    if (!value) return fail(std::string(key) + ": write " + std::string(usage_of(key)));
    auto& members = changes[id];
    if (!members.is_object()) members = json::object();
    members[std::string(key)] = std::move(*value);
    if (auto fault = members_fault(members); !fault.empty()) return fail(std::move(fault));
    return true;
}

Expected<Meanings> changed(Meanings meanings, const MeaningChanges& changes) {
    for (const auto& [id, change] : changes) {
        const auto known = meanings.find(id);
        auto members = known == meanings.end() || change.is_null() ? json::object() : to_json(known->second);
        if (!change.is_null()) members.merge_patch(change);
        if (members.empty()) {
            meanings.erase(id);
            continue;
        }
        std::string fault;
        JsonReader reader(members, "/meanings/" + id, fault);
        meanings[id] = read_meaning(reader);
        if (!reader.ok()) return fail(std::move(fault));
    }
    if (auto fault = bounds_fault(meanings); !fault.empty()) return fail(std::move(fault));
    return meanings;
}

json to_json(const Meaning& meaning) {
    json object = json::object();
    if (!meaning.klass.empty()) object["class"] = meaning.klass;
    if (meaning.inverted) object["inverted"] = *meaning.inverted;
    if (meaning.debounce_ms) object["debounce"] = *meaning.debounce_ms;
    if (!meaning.unit.empty()) object["unit"] = meaning.unit;
    if (meaning.line) object["line"] = *meaning.line;
    if (!meaning.icon.empty()) object["icon"] = meaning.icon;
    if (meaning.hidden) object["hidden"] = true;
    return object;
}

void put_meanings(json& object, const Meanings& meanings) {
    for (const auto& [id, meaning] : meanings)
        object["meanings"][id] = to_json(meaning);
}

Meaning read_meaning(JsonReader& reader) {
    Meaning meaning;
    meaning.klass = read_word(reader, "class");
    if (!meaning.klass.empty() && !use_of_class(meaning.klass))
        reader.fault("class", class_fault(meaning.klass));
    meaning.inverted = read_flag(reader, "inverted");
    if (const auto debounce = reader.integer("debounce", 0, kMaxDebounceMs))
        meaning.debounce_ms = static_cast<int>(*debounce);
    meaning.unit = read_word(reader, "unit");
    meaning.line = read_line(reader);
    meaning.icon = read_word(reader, "icon");
    meaning.hidden = read_flag(reader, "hidden").value_or(false);
    return meaning;
}

Meanings read_meanings(JsonReader& reader) {
    Meanings meanings;
    auto members = reader.object("meanings");
    if (!members) return meanings;
    if (members->value().size() > kMaxMeanings) members->fault({}, "has too many members");
    for (auto& [id, each] : reader.members("meanings")) {
        if (!reader.ok()) return {};
        if (!is_id(id)) members->fault({}, "has a member that is no id of a property");
        meanings[id] = read_meaning(each);
    }
    if (auto fault = reader.ok() ? bounds_fault(meanings) : std::string(); !fault.empty())
        reader.fault("meanings", fault);
    return meanings;
}

MeaningChanges read_meaning_changes(JsonReader& reader) {
    MeaningChanges changes;
    const auto members = reader.object("meanings");
    if (!members) return changes;
    for (const auto& [id, change] : members->value().items()) {
        if (!is_id(id)) {
            reader.fault("meanings", "has a member that is no id of a property: " + text::printable(id));
            return {};
        }
        if (!change.is_null() && !change.is_object()) {
            reader.fault("meanings", id + ": is neither an object nor null");
            return {};
        }
        if (auto fault = change.is_null() ? std::string() : members_fault(change); !fault.empty()) {
            reader.fault("meanings", id + ": " + fault);
            return {};
        }
        changes[id] = change;
    }
    return changes;
}

}  // namespace asip::model
