// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/text/json_reader.hpp"
#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

using nlohmann::json;
using text::JsonReader;

constexpr std::size_t kMaxTextBytes = 256;
constexpr JsonLimits kDescriptionLimits = {kMaxDescriptionBytes, 16};

// To JSON

void put_text(json& object, const char* key, const std::string& text) {
    if (!text.empty()) object[key] = text;
}

json firmware_json(const FirmwareInfo& firmware) {
    json object = json::object();
    put_text(object, "protocol", firmware.protocol);
    put_text(object, "chip", firmware.chip);
    put_text(object, "sketch", firmware.sketch);
    put_text(object, "version", firmware.version);
    put_text(object, "available", firmware.available);
    for (const auto& [tag, version] : firmware.extensions.list)
        object["extensions"][std::string(1, tag)] = version;
    return object;
}

json link_json(const LinkInfo& link) {
    json object = json::object();
    put_text(object, "kind", link.kind);
    put_text(object, "path", link.path);
    if (link.baud != 0) object["baud"] = link.baud;
    return object;
}

json agent_json(const AgentInfo& agent) {
    json object = json::object();
    put_text(object, "version", agent.version);
    put_text(object, "host", agent.host);
    put_text(object, "client", agent.client);
    return object;
}

json pins_json(const PinsInfo& pins) {
    json object = json::object();
    put_text(object, "capabilities", pins.capabilities);
    put_text(object, "owners", pins.owners);
    put_text(object, "modes", pins.modes);
    for (const auto& [pin, channel] : pins.analog)
        object["analog"][std::to_string(pin)] = channel;
    return object;
}

json service_json(const ServiceInfo& service) {
    json object = {{"name", service.name}};
    if (service.id != 0) object["id"] = std::string(1, service.id);
    if (service.own_model)
        object["model"] = json::parse(service.own_model->source, nullptr, false);
    else
        put_text(object, "model", service.model);
    put_text(object, "title", service.title);
    if (service.count) object["count"] = *service.count;
    if (service.period) object["period"] = *service.period;
    return object;
}

void put_object(json& document, const char* key, json object) {
    if (!object.empty()) document[key] = std::move(object);
}

// From JSON

/// A text that is fit to be shown to a person.
std::string read_text(JsonReader& reader, const char* key, std::size_t max_bytes = kMaxTextBytes) {
    auto text = reader.text(key, {}, max_bytes);
    if (!text::is_showable(text)) reader.fault(key, "holds control characters");
    return text;
}

std::optional<int> read_small(JsonReader& reader, std::string_view key, int max) {
    const auto value = reader.integer(key, 0, static_cast<std::uint64_t>(max));
    if (!value) return std::nullopt;
    return static_cast<int>(*value);
}

FirmwareInfo read_firmware(JsonReader reader) {
    FirmwareInfo firmware{read_text(reader, "protocol"), read_text(reader, "chip"),
                          read_text(reader, "sketch"),   {},
                          read_text(reader, "version"),  read_text(reader, "available")};
    auto extensions = reader.object("extensions");
    if (!extensions) return firmware;
    for (const auto& [tag, member] : extensions->value().items()) {
        if (tag.size() != 1 || tag < "!" || tag > "~") extensions->fault({}, "a tag is one character");
        const auto version = read_small(*extensions, tag, 255);
        if (!reader.ok()) return firmware;
        firmware.extensions.list.emplace_back(tag.front(), version.value_or(0));
    }
    return firmware;
}

LinkInfo read_link(JsonReader reader) {
    return {read_text(reader, "kind"), read_text(reader, "path"),
            read_small(reader, "baud", 100'000'000).value_or(0)};
}

AgentInfo read_agent(JsonReader reader) {
    return {read_text(reader, "version"), read_text(reader, "host"), read_text(reader, "client")};
}

/// One character a pin, each among those allowed.
std::string pin_text(JsonReader& reader, const char* key, bool (*allowed)(char)) {
    auto pins = read_text(reader, key);
    if (!std::all_of(pins.begin(), pins.end(), allowed))
        reader.fault(key, "holds a character that stands for nothing");
    return pins;
}

/// The pin that a key names; nothing when it names none.
std::optional<std::uint8_t> pin_of(const std::string& key) {
    const bool digits =
        !key.empty() && key.size() <= 3 && key.find_first_not_of("0123456789") == std::string::npos;
    const int pin = digits ? std::stoi(key) : 256;
    if (pin > 255) return std::nullopt;
    return static_cast<std::uint8_t>(pin);
}

PinsInfo read_pins(JsonReader reader) {
    static_assert(kMaxTextBytes == protocol::kMaxPins);
    PinsInfo pins;
    pins.capabilities = pin_text(reader, "capabilities", [](char c) { return c >= '0' && c <= '7'; });
    pins.owners =
        pin_text(reader, "owners", [](char c) { return (c >= 'A' && c <= 'Z') || c == '@' || c == '-'; });
    pins.modes = pin_text(reader, "modes", [](char c) { return c >= '0' && c <= '8'; });
    auto analog = reader.object("analog");
    if (!analog) return pins;
    if (analog->value().size() > protocol::kMaxPins) analog->fault({}, "has more than 256 members");
    for (const auto& [key, member] : analog->value().items()) {
        const auto pin = pin_of(key);
        if (!pin) analog->fault({}, "a key is not a pin");
        const auto channel = read_small(*analog, key, 255);
        if (!reader.ok()) return pins;
        pins.analog.emplace_back(*pin, static_cast<std::uint8_t>(channel.value_or(0)));
    }
    std::sort(pins.analog.begin(), pins.analog.end());
    return pins;
}

void read_model(JsonReader& reader, const json& member, ServiceInfo& service) {
    if (member.is_string()) {
        service.model = member.get<std::string>();
        const auto at = service.model.find('@');
        const auto version = at == std::string::npos ? std::string{} : service.model.substr(at + 1);
        const bool valid = valid_name(service.model.substr(0, at)) && !version.empty() &&
                           version.size() <= 4 &&
                           version.find_first_not_of("0123456789") == std::string::npos;
        if (!valid) reader.fault("model", "is not NAME@VERSION");
    } else if (member.is_object()) {
        auto model = service_model_from_json(member);
        if (!model) return reader.fault("model", model.error());
        model->example_source.clear();
        service.own_model = std::make_shared<const ServiceModel>(std::move(*model));
    } else {
        reader.fault("model", "is neither a name nor a model");
    }
}

ServiceInfo read_service(JsonReader& reader) {
    ServiceInfo service;
    service.name = read_text(reader, "name");
    if (!valid_name(service.name)) reader.fault("name", "is not a valid name");
    const auto id = read_text(reader, "id");
    if (!id.empty()) {
        service.id = id.front();
        if (id.size() != 1 || id.front() < 'A' || id.front() > 'Z')
            reader.fault("id", "is not a letter A to Z");
    }
    service.title = read_text(reader, "title");
    service.count = read_small(reader, "count", 65535);
    service.period = read_small(reader, "period", 65535);
    const auto* model = reader.find("model");
    if (model != nullptr && reader.ok()) read_model(reader, *model, service);
    return service;
}

std::vector<ServiceInfo> read_services(JsonReader& reader) {
    std::vector<ServiceInfo> services;
    auto readers = reader.list("services", kMaxDescriptionServices);
    std::set<std::string_view> names;
    services.reserve(readers.size());
    for (auto& each : readers) {
        services.push_back(read_service(each));
        if (!names.insert(services.back().name).second) each.fault("name", "is there twice");
        if (!reader.ok()) break;
    }
    return services;
}

std::vector<std::string> read_warnings(JsonReader& reader) {
    std::vector<std::string> warnings;
    const auto* list = reader.find("warnings");
    if (list == nullptr) return warnings;
    if (!list->is_array() || list->size() > kMaxWarnings)
        reader.fault("warnings", "is not a short list of texts");
    for (std::size_t i = 0; reader.ok() && i < list->size(); ++i) {
        const auto& text = (*list)[i];
        const bool good = text.is_string() && text.get_ref<const std::string&>().size() <= kMaxWarningBytes &&
                          text::is_showable(text.get_ref<const std::string&>());
        if (!good) reader.fault("warnings", "holds what is no text to be shown");
        if (good) warnings.push_back(text.get<std::string>());
    }
    return warnings;
}

OnDemandInfo read_on_demand(JsonReader reader) {
    return {read_small(reader, "fastest", 65535).value_or(0),
            read_small(reader, "resting", 65535).value_or(0)};
}

StopInfo read_stopped(JsonReader reader) {
    return {read_text(reader, "by"), read_text(reader, "why"), read_text(reader, "since")};
}

json state_json(const SaidState& said) {
    json object = {{"is", to_text(said.state)}, {"age", std::floor(said.age * 1000) / 1000}};
    if (said.reason != StateReason::kNone) object["reason"] = to_text(said.reason);
    return object;
}

SaidState read_state(JsonReader reader) {
    SaidState said;
    reader.required("is");
    const auto word = board_state_from_text(read_text(reader, "is"));
    if (!word) reader.fault("is", "is not a state");
    said.state = word.value_or(BoardState::kLost);
    said.reason = state_reason_from_text(read_text(reader, "reason"));
    said.age = reader.number("age", 0, 0, kMaxStateAgeSeconds);
    return said;
}

}  // namespace

nlohmann::json to_json(const Description& description) {
    json document = {{"board", description.board},
                     {"session", description.session},
                     {"seq", description.seq},
                     {"lease", description.lease}};
    put_object(document, "firmware", firmware_json(description.firmware));
    put_object(document, "link", link_json(description.link));
    put_object(document, "agent", agent_json(description.agent));
    put_object(document, "pins", pins_json(description.pins));
    auto& services = document["services"] = json::array();
    for (const auto& service : description.services)
        services.push_back(service_json(service));
    put_labels(document, description.labels);
    if (!description.labels_fault.empty()) document["labels_fault"] = description.labels_fault;
    if (!description.warnings.empty()) document["warnings"] = description.warnings;
    if (description.state) document["state"] = state_json(*description.state);
    if (const auto& reports = description.on_demand)
        document["on_demand"] = {{"fastest", reports->fastest}, {"resting", reports->resting}};
    if (const auto& stop = description.stopped)
        document["stopped"] = {{"by", stop->by}, {"why", stop->why}, {"since", stop->since}};
    return document;
}

std::string to_text(const Description& description) {
    return dump_json(to_json(description));
}

Expected<Description> description_from_json(const nlohmann::json& document) {
    std::string fault;
    JsonReader reader(document, "", fault);
    for (const auto* key : {"board", "session", "seq", "services"})
        reader.required(key);
    if (!reader.ok()) return fail(fault);
    Description result;
    result.board = read_text(reader, "board");
    if (!valid_board_name(result.board)) reader.fault("board", explain_board_name(result.board));
    result.session = read_text(reader, "session");
    if (!valid_name(result.session)) reader.fault("session", "is not a valid session");
    result.seq = reader.integer("seq", 0, std::numeric_limits<std::int64_t>::max()).value_or(0);
    result.lease =
        static_cast<int>(reader.integer("lease", 1, kMaxLeaseSeconds).value_or(kDefaultLeaseSeconds));
    if (auto member = reader.object("firmware")) result.firmware = read_firmware(std::move(*member));
    if (auto member = reader.object("link")) result.link = read_link(std::move(*member));
    if (auto member = reader.object("agent")) result.agent = read_agent(std::move(*member));
    if (auto member = reader.object("pins")) result.pins = read_pins(std::move(*member));
    if (auto member = reader.object("state")) result.state = read_state(std::move(*member));
    if (auto member = reader.object("on_demand")) result.on_demand = read_on_demand(std::move(*member));
    if (auto member = reader.object("stopped")) result.stopped = read_stopped(std::move(*member));
    if (reader.ok()) result.services = read_services(reader);
    if (reader.ok()) result.labels = read_labels(reader);
    if (reader.ok()) result.warnings = read_warnings(reader);
    result.labels_fault = read_text(reader, "labels_fault", kMaxFaultBytes);
    if (!reader.ok()) return fail(fault);
    return result;
}

Expected<Description> parse_description(std::string_view text) {
    const auto document = parse_json(text, kDescriptionLimits);
    if (!document) return fail("/: " + document.error());
    return description_from_json(*document);
}

}  // namespace asip::model
