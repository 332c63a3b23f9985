// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/description_parts.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/model/description.hpp"
#include "asip/model/names.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::catalogue {

namespace {

using bus::JsonScanner;

constexpr std::size_t kMaxTextBytes = 256;

std::string string_member(const nlohmann::json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_string()) return {};
    return found->get<std::string>().substr(0, kMaxTextBytes);
}

// Every member "unit" below `value`: a model's units are in the fields of its events and the arguments of its
// commands, at some depth.
void collect_units(const nlohmann::json& value, std::vector<std::string>& units) {
    for (const auto& item : value.items()) {
        if (item.value().is_string() && item.key() == "unit") {
            units.push_back(item.value().get<std::string>());
        } else if (item.value().is_structured()) {
            collect_units(item.value(), units);
        }
    }
}

// The text of a JSON value that is a string; else nothing. Cut where it is longer than a person needs.
std::string text_of(std::string_view value) {
    if (value.size() < 2 || value.front() != '"') return {};
    return unescape(value.substr(1, std::min(value.size() - 2, kMaxTextBytes)));
}

struct RawService {
    std::string_view name, id, model, title, own_model;
    std::uint64_t count = 0, period = 0;
    bool has_count = false, has_period = false;
};

bool read_service(JsonScanner& in, RawService& service) {
    std::string_view key;
    std::string_view ignored;
    while (in.next_member(key)) {
        if (key == "name") {
            if (!in.plain_string(service.name)) return false;
        } else if (key == "id") {
            if (!in.plain_string(service.id) || service.id.size() != 1) return false;
        } else if (key == "model") {
            if (!in.plain_string(service.model) && !in.value(service.own_model)) return false;
            if (!service.own_model.empty() && service.own_model.front() != '{') return false;
        } else if (key == "title") {
            std::string_view raw;
            if (!in.value(raw) || raw.size() < 2 || raw.front() != '"') return false;
            service.title = raw.substr(1, raw.size() - 2);
        } else if (key == "count") {
            if (!in.unsigned_integer(service.count) || service.count > INT32_MAX) return false;
            service.has_count = true;
        } else if (key == "period") {
            if (!in.unsigned_integer(service.period) || service.period > INT32_MAX) return false;
            service.has_period = true;
        } else if (!in.value(ignored)) {
            return false;
        }
    }
    return in.left() && model::valid_name(service.name) && service.title.size() <= kMaxTextBytes &&
           service.model.size() <= kMaxTextBytes;
}

// The kind of a service: its model's name, else its letter, else its own name.
std::string kind_of(const RawService& raw, std::vector<std::string>& units) {
    if (!raw.model.empty()) return std::string(raw.model.substr(0, raw.model.find('@')));
    if (!raw.own_model.empty()) {
        const auto own = nlohmann::json::parse(raw.own_model, nullptr, false);
        if (own.is_object()) {
            for (const char* const part : {"events", "commands"}) {
                if (const auto found = own.find(part); found != own.end()) collect_units(*found, units);
            }
            if (auto name = string_member(own, "name"); model::valid_name(name)) return name;
        }
    }
    return raw.id.empty() ? std::string(raw.name) : std::string(raw.id);
}

void count_kind(ServicesPart& part, Kind* kind) {
    const auto known = std::find_if(part.kinds.begin(), part.kinds.end(),
                                    [&](const auto& entry) { return entry.first == kind; });
    if (known == part.kinds.end()) {
        part.kinds.emplace_back(kind, 1);
    } else {
        ++known->second;
    }
}

bool read_into(ServicesPart& part, KindTable& kinds) {
    JsonScanner in(part.text);
    if (!in.enter_array()) return false;
    while (in.next_element()) {
        JsonScanner element = in;
        std::string_view text;
        RawService raw;
        if (!in.value(text) || !element.enter_object() || !read_service(element, raw)) return false;
        const auto same = [&](const Service& other) { return other.name == raw.name; };
        if (part.services.size() == model::kMaxDescriptionServices ||
            std::any_of(part.services.begin(), part.services.end(), same)) {
            return false;
        }
        std::vector<std::string> units;
        const std::string kind_name = kind_of(raw, units);
        if (!model::valid_name(kind_name)) return false;
        Service service;
        service.name = raw.name;
        service.model = raw.model;
        service.title = raw.title;
        // A service announced by its name only is taken for the standard one of that name.
        const bool name_only = raw.model.empty() && raw.own_model.empty() && raw.id.empty();
        service.kind = kinds.refer(kind_name, name_only ? raw.name : raw.model);
        service.id = raw.id.empty() ? '\0' : raw.id.front();
        if (raw.has_count) service.count = static_cast<std::int32_t>(raw.count);
        if (raw.has_period) service.period = static_cast<std::int32_t>(raw.period);
        for (std::string& unit : units) {
            part.own_units.emplace_back(static_cast<std::uint16_t>(part.services.size()), std::move(unit));
        }
        part.services.push_back(service);
        count_kind(part, service.kind);
    }
    part.services.shrink_to_fit();
    part.kinds.shrink_to_fit();
    return in.left();
}

/// A part made of an object's members, each given to `take`; null when the text is not an object.
template <class Part, class Take>
std::unique_ptr<Part> read_object(std::string_view text, Take take) {
    auto part = std::make_unique<Part>();
    part->text = text;
    JsonScanner in(text);
    std::string_view key;
    std::string_view value;
    if (!in.enter_object()) return nullptr;
    while (in.next_member(key)) {
        if (!in.value(value)) return nullptr;
        take(*part, key, value);
    }
    return in.left() ? std::move(part) : nullptr;
}

/// As `==`, with a length that the compiler knows: each description has a dozen keys, each of which is
/// compared with a dozen names.
template <std::size_t Size>
bool is(std::string_view key, const char (&name)[Size]) {
    return key.size() == Size - 1 && std::memcmp(key.data(), name, Size - 1) == 0;
}

bool read_structure(JsonScanner& in, std::string_view guess, char open, std::string_view& text) {
    if (in.known_value(guess)) {
        text = guess;
        return true;
    }
    return in.value(text) && text.front() == open;
}

bool read_number(std::string_view text, double& number) {
    const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
    return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

bool read_state(std::string_view text, std::optional<model::SaidState>& state) {
    JsonScanner in(text);
    if (!in.enter_object()) return false;
    model::SaidState said;
    std::optional<model::BoardState> word;
    std::string_view key;
    std::string_view value;
    while (in.next_member(key)) {
        if (is(key, "is") || is(key, "reason")) {
            if (!in.plain_string(value)) return false;
            if (is(key, "is")) word = model::board_state_from_text(value);
            if (is(key, "reason")) said.reason = model::state_reason_from_text(value);
        } else {
            if (!in.value(value)) return false;
            if (is(key, "age") &&
                !(read_number(value, said.age) && said.age >= 0 && said.age <= model::kMaxStateAgeSeconds))
                return false;
        }
    }
    if (!in.left() || !word) return false;
    said.state = *word;
    state = said;
    return true;
}

bool read_member(JsonScanner& in, std::string_view key, const Guesses& guesses, DescriptionMembers& members,
                 unsigned& seen) {
    enum : unsigned {
        kBoard = 1,
        kSession = 2,
        kSeq = 4,
        kLease = 8,
        kFirmware = 16,
        kPins = 32,
        kServices = 64,
        kAgent = 128,
        kLink = 256,
        kLabels = 512,
        kNames = 1024,
        kState = 2048
    };
    const auto once = [&seen](unsigned bit) { return (seen & bit) == 0 && (seen |= bit) != 0; };
    if (is(key, "board")) return once(kBoard) && in.plain_string(members.board);
    if (is(key, "session")) return once(kSession) && in.plain_string(members.session);
    if (is(key, "seq")) return once(kSeq) && in.unsigned_integer(members.seq);
    if (is(key, "lease")) return once(kLease) && in.unsigned_integer(members.lease);
    if (is(key, "firmware"))
        return once(kFirmware) && read_structure(in, guesses.firmware, '{', members.firmware);
    if (is(key, "pins")) return once(kPins) && read_structure(in, guesses.pins, '{', members.pins);
    if (is(key, "services"))
        return once(kServices) && read_structure(in, guesses.services, '[', members.services);
    if (is(key, "agent")) return once(kAgent) && read_structure(in, guesses.agent, '{', members.agent);
    if (is(key, "link")) return once(kLink) && read_structure(in, guesses.link, '{', members.link);
    std::string_view value;
    if (!in.value(value)) return false;
    if (is(key, "state")) return once(kState) && read_state(value, members.state);
    if (is(key, "labels") && !once(kLabels)) return false;
    if (is(key, "names") && !once(kNames)) return false;
    if (is(key, "labels")) members.labels = value;
    if (is(key, "names")) members.names = value;
    if (!members.extra.empty()) members.extra += ',';
    members.extra.append("\"").append(in.raw_key()).append("\":").append(value);
    return true;
}

}  // namespace

std::unique_ptr<FirmwarePart> read_firmware(std::string_view text) {
    auto read =
        read_object<FirmwarePart>(text, [](FirmwarePart& part, std::string_view key, std::string_view value) {
            if (key == "chip") part.chip = text_of(value);
            if (key == "sketch") part.sketch = text_of(value);
            if (key == "protocol") part.protocol = text_of(value);
            if (key == "version") part.version = text_of(value);
            if (key == "available") part.available = text_of(value);
        });
    if (read) read->shown = bus::firmware_text(read->sketch, read->version, read->available);
    return read;
}

std::unique_ptr<PinsPart> read_pins(std::string_view text) {
    return read_object<PinsPart>(text, [](PinsPart& part, std::string_view key, std::string_view value) {
        if (key != "capabilities") return;
        for (const char digit : text_of(value)) {
            if (digit >= '0' && digit <= '7') part.capabilities |= static_cast<unsigned>(digit - '0');
        }
    });
}

std::unique_ptr<ServicesPart> read_services(std::string_view text, KindTable& kinds) {
    auto part = std::make_unique<ServicesPart>();
    part->text = text;
    if (read_into(*part, kinds)) return part;
    for (const Service& service : part->services)
        kinds.release(service.kind);
    return nullptr;
}

std::unique_ptr<model::Labels> read_labels(std::string_view labels, std::string_view names) {
    if (labels.empty() && names.empty()) return std::make_unique<model::Labels>();
    auto members = nlohmann::json::object();
    if (!labels.empty()) members["labels"] = nlohmann::json::parse(labels, nullptr, false);
    if (!names.empty()) members["names"] = nlohmann::json::parse(names, nullptr, false);
    std::string fault;
    text::JsonReader reader(members, "", fault);
    auto read = std::make_unique<model::Labels>(model::read_labels(reader));
    return reader.ok() ? std::move(read) : nullptr;
}

std::string unescape(std::string_view raw) {
    if (raw.find('\\') == std::string_view::npos) return std::string(raw);
    const auto json = nlohmann::json::parse('"' + std::string(raw) + '"', nullptr, false);
    return json.is_string() ? json.get<std::string>() : std::string(raw);
}

bool read_description(std::string_view payload, const Guesses& guesses, DescriptionMembers& members) {
    constexpr unsigned kNeeded = 1 | 2 | 4 | 64;  // board, session, seq, services
    JsonScanner in(payload);
    if (!in.enter_object()) return false;
    unsigned seen = 0;
    std::string_view key;
    while (in.next_member(key)) {
        if (!read_member(in, key, guesses, members, seen)) return false;
    }
    return in.left() && in.at_end() && (seen & kNeeded) == kNeeded;
}

}  // namespace asip::catalogue
