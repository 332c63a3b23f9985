#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/protocol/limits.hpp"
#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxTextBytes = 256;
constexpr JsonLimits kDescriptionLimits = {kMaxDescriptionBytes, 16};

// --- to JSON
// ---------------------------------------------------------------------------------------------------------

void put_text(json& object, const char* key, const std::string& text) {
    if (!text.empty()) object[key] = text;
}

json firmware_json(const FirmwareInfo& firmware) {
    json object = json::object();
    put_text(object, "protocol", firmware.protocol);
    put_text(object, "chip", firmware.chip);
    put_text(object, "sketch", firmware.sketch);
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
    if (service.own_model) {
        object["model"] = json::parse(service.own_model->source, nullptr, false);
    } else {
        put_text(object, "model", service.model);
    }
    put_text(object, "title", service.title);
    if (service.count) object["count"] = *service.count;
    if (service.period) object["period"] = *service.period;
    return object;
}

void put_object(json& document, const char* key, json object) {
    if (!object.empty()) document[key] = std::move(object);
}

// --- from JSON
// -------------------------------------------------------------------------------------------------------

/// Reads members and keeps the first fault; after one, what it returns does not matter.
class Reader {
  public:
    bool ok() const { return fault_.empty(); }
    const std::string& fault() const { return fault_; }

    void set_fault(const std::string& place, const std::string& reason) {
        if (fault_.empty()) fault_ = place + ": " + reason;
    }

    /// The member, or null where it is absent.
    const json* find(const json& object, const char* key) {
        const auto found = object.find(key);
        return found == object.end() ? nullptr : &*found;
    }

    const json* find_object(const json& object, const char* key, const std::string& place) {
        const auto* member = find(object, key);
        if (member == nullptr || member->is_object()) return member;
        set_fault(place + "/" + key, "is not an object");
        return nullptr;
    }

    std::string text(const json& object, const char* key, const std::string& place) {
        const auto* member = find(object, key);
        if (member == nullptr) return {};
        if (!member->is_string()) {
            set_fault(place + "/" + key, "is not a string");
            return {};
        }
        const auto& text = member->get_ref<const std::string&>();
        if (text.size() > kMaxTextBytes) {
            set_fault(place + "/" + key, "is longer than 256 bytes");
            return {};
        }
        if (!text::is_showable(text)) set_fault(place + "/" + key, "holds control characters");
        return text;
    }

    std::optional<std::uint64_t> number(const json& object, const char* key, const std::string& place,
                                        std::uint64_t max) {
        const auto* member = find(object, key);
        if (member == nullptr) return std::nullopt;
        if (!member->is_number_unsigned() &&
            !(member->is_number_integer() && member->get<std::int64_t>() >= 0)) {
            set_fault(place + "/" + key, "is not an integer from 0");
            return std::nullopt;
        }
        const auto number = member->get<std::uint64_t>();
        if (number > max) {
            set_fault(place + "/" + key, std::to_string(number) + " is above " + std::to_string(max));
            return std::nullopt;
        }
        return number;
    }

    std::optional<int> small(const json& object, const char* key, const std::string& place, int max) {
        const auto value = number(object, key, place, static_cast<std::uint64_t>(max));
        if (!value) return std::nullopt;
        return static_cast<int>(*value);
    }

  private:
    std::string fault_;
};

FirmwareInfo read_firmware(Reader& reader, const json& object, const std::string& place) {
    FirmwareInfo firmware{reader.text(object, "protocol", place),
                          reader.text(object, "chip", place),
                          reader.text(object, "sketch", place),
                          {}};
    const auto* extensions = reader.find_object(object, "extensions", place);
    if (extensions == nullptr) return firmware;
    for (auto it = extensions->begin(); it != extensions->end(); ++it) {
        const auto inner = place + "/extensions";
        if (it.key().size() != 1 || it.key() < "!" || it.key() > "~")
            reader.set_fault(inner, "a tag is one character");
        const auto version = reader.small(*extensions, it.key().c_str(), inner, 255);
        if (!reader.ok()) return firmware;
        firmware.extensions.list.emplace_back(it.key().front(), version.value_or(0));
    }
    return firmware;
}

LinkInfo read_link(Reader& reader, const json& object, const std::string& place) {
    return {reader.text(object, "kind", place), reader.text(object, "path", place),
            reader.small(object, "baud", place, 100'000'000).value_or(0)};
}

AgentInfo read_agent(Reader& reader, const json& object, const std::string& place) {
    return {reader.text(object, "version", place), reader.text(object, "host", place),
            reader.text(object, "client", place)};
}

/// One character a pin, each among those allowed.
std::string pin_text(Reader& reader, const json& object, const char* key, const std::string& place,
                     bool (*allowed)(char)) {
    auto text = reader.text(object, key, place);
    for (const char c : text) {
        if (!allowed(c)) reader.set_fault(place + "/" + key, "holds a character that stands for nothing");
    }
    return text;
}

PinsInfo read_pins(Reader& reader, const json& object, const std::string& place) {
    static_assert(kMaxTextBytes == protocol::kMaxPins);
    PinsInfo pins;
    pins.capabilities =
        pin_text(reader, object, "capabilities", place, [](char c) { return c >= '0' && c <= '7'; });
    pins.owners = pin_text(reader, object, "owners", place,
                           [](char c) { return (c >= 'A' && c <= 'Z') || c == '@' || c == '-'; });
    pins.modes = pin_text(reader, object, "modes", place, [](char c) { return c >= '0' && c <= '8'; });
    const auto* analog = reader.find_object(object, "analog", place);
    if (analog == nullptr) return pins;
    if (analog->size() > protocol::kMaxPins) reader.set_fault(place + "/analog", "has more than 256 members");
    for (auto it = analog->begin(); it != analog->end() && reader.ok(); ++it) {
        const auto& key = it.key();
        const bool digits =
            !key.empty() && key.size() <= 3 && key.find_first_not_of("0123456789") == std::string::npos;
        const int pin = digits ? std::stoi(key) : 256;
        if (pin > 255) reader.set_fault(place + "/analog", "a key is not a pin");
        const auto channel = reader.small(*analog, key.c_str(), place + "/analog", 255);
        if (!reader.ok()) return pins;
        pins.analog.emplace_back(static_cast<std::uint8_t>(pin),
                                 static_cast<std::uint8_t>(channel.value_or(0)));
    }
    std::sort(pins.analog.begin(), pins.analog.end());
    return pins;
}

void read_model(Reader& reader, const json& member, const std::string& place, ServiceInfo& service) {
    if (member.is_string()) {
        service.model = member.get<std::string>();
        const auto at = service.model.find('@');
        const auto version = at == std::string::npos ? std::string{} : service.model.substr(at + 1);
        const bool valid = valid_name(service.model.substr(0, at)) && !version.empty() &&
                           version.size() <= 4 &&
                           version.find_first_not_of("0123456789") == std::string::npos;
        if (!valid) reader.set_fault(place, "is not NAME@VERSION");
    } else if (member.is_object()) {
        auto model = service_model_from_json(member);
        if (!model) return reader.set_fault(place, model.error());
        model->example_source.clear();
        service.own_model = std::make_shared<const ServiceModel>(std::move(*model));
    } else {
        reader.set_fault(place, "is neither a name nor a model");
    }
}

ServiceInfo read_service(Reader& reader, const json& object, const std::string& place) {
    ServiceInfo service;
    if (!object.is_object()) {
        reader.set_fault(place, "is not an object");
        return service;
    }
    service.name = reader.text(object, "name", place);
    if (reader.ok() && !valid_name(service.name)) reader.set_fault(place + "/name", "is not a valid name");
    const auto id = reader.text(object, "id", place);
    if (!id.empty()) {
        service.id = id.front();
        if (id.size() != 1 || id.front() < 'A' || id.front() > 'Z')
            reader.set_fault(place + "/id", "is not a letter A to Z");
    }
    service.title = reader.text(object, "title", place);
    service.count = reader.small(object, "count", place, 65535);
    service.period = reader.small(object, "period", place, 65535);
    const auto* model = reader.find(object, "model");
    if (model != nullptr && reader.ok()) read_model(reader, *model, place + "/model", service);
    return service;
}

std::vector<ServiceInfo> read_services(Reader& reader, const json& document) {
    std::vector<ServiceInfo> services;
    const auto* list = reader.find(document, "services");
    if (list == nullptr || !list->is_array()) {
        reader.set_fault("/services", list == nullptr ? "is missing" : "is not an array");
        return services;
    }
    if (list->size() > kMaxDescriptionServices) reader.set_fault("/services", "has more than 64 items");
    std::set<std::string_view> names;
    services.reserve(std::min(list->size(), kMaxDescriptionServices));
    for (std::size_t i = 0; i < list->size() && reader.ok(); ++i) {
        const auto place = "/services/" + std::to_string(i);
        services.push_back(read_service(reader, (*list)[i], place));
        if (!names.insert(services.back().name).second) reader.set_fault(place + "/name", "is there twice");
    }
    return services;
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
    return document;
}

std::string to_text(const Description& description) {
    return dump_json(to_json(description));
}

Expected<Description> description_from_json(const nlohmann::json& document) {
    if (!document.is_object()) return fail("/: is not an object");
    Reader reader;
    Description result;
    for (const auto* key : {"board", "session", "seq"}) {
        if (!document.contains(key)) return fail(std::string("/") + key + ": is missing");
    }
    result.board = reader.text(document, "board", "");
    if (reader.ok() && !valid_board_name(result.board))
        reader.set_fault("/board", explain_board_name(result.board));
    result.session = reader.text(document, "session", "");
    if (reader.ok() && !valid_name(result.session)) reader.set_fault("/session", "is not a valid session");
    result.seq = reader.number(document, "seq", "", std::numeric_limits<std::int64_t>::max()).value_or(0);
    result.lease = reader.small(document, "lease", "", kMaxLeaseSeconds).value_or(kDefaultLeaseSeconds);
    if (result.lease == 0) reader.set_fault("/lease", "0 is below 1");
    if (const auto* member = reader.find_object(document, "firmware", "")) {
        result.firmware = read_firmware(reader, *member, "/firmware");
    }
    if (const auto* member = reader.find_object(document, "link", ""))
        result.link = read_link(reader, *member, "/link");
    if (const auto* member = reader.find_object(document, "agent", ""))
        result.agent = read_agent(reader, *member, "/agent");
    if (const auto* member = reader.find_object(document, "pins", ""))
        result.pins = read_pins(reader, *member, "/pins");
    if (reader.ok()) result.services = read_services(reader, document);
    if (!reader.ok()) return fail(reader.fault());
    return result;
}

Expected<Description> parse_description(std::string_view text) {
    const auto document = parse_json(text, kDescriptionLimits);
    if (!document) return fail("/: " + document.error());
    return description_from_json(*document);
}

}  // namespace asip::model
