#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"
#include "asip/protocol/extensions.hpp"

namespace asip::model {

inline constexpr std::size_t kMaxDescriptionBytes = std::size_t{64} * 1024;
inline constexpr std::size_t kMaxDescriptionServices = 64;
inline constexpr int kDefaultLeaseSeconds = 60;
inline constexpr int kMaxLeaseSeconds = 24 * 60 * 60;

struct FirmwareInfo {
    std::string protocol;  // "0.4"
    std::string chip;
    std::string sketch;
    protocol::Extensions extensions;
    friend bool operator==(const FirmwareInfo&, const FirmwareInfo&) = default;
};

struct LinkInfo {
    std::string kind;  // "serial", "tcp", "sim", ...
    std::string path;  // port, or host:port
    int baud = 0;      // 0: does not apply
    friend bool operator==(const LinkInfo&, const LinkInfo&) = default;
};

struct AgentInfo {
    std::string version;
    std::string host;
    std::string client;  // MQTT client id
    friend bool operator==(const AgentInfo&, const AgentInfo&) = default;
};

/// One character a pin in the three texts, as on the bus; texts that are empty are unknown.
struct PinsInfo {
    std::string capabilities;  // digits of bits: 1 digital, 2 analog in, 4 PWM
    std::string owners;        // service letter, '@' system, '-' none
    std::string modes;         // digits of protocol::PinMode
    std::vector<std::pair<std::uint8_t, std::uint8_t>> analog;  // digital pin, analog channel

    bool empty() const { return capabilities.empty() && owners.empty() && modes.empty() && analog.empty(); }
    friend bool operator==(const PinsInfo&, const PinsInfo&) = default;
};

struct ServiceInfo {
    std::string name;                               // on the bus: the model's name, or the letter
    char id = 0;                                    // 0: not said (a board that only publishes names)
    std::string model;                              // "distance@1"; empty: no model, or `own_model`
    std::shared_ptr<const ServiceModel> own_model;  // carried in full; null for standard ones
    std::string title;                              // the board's friendly name
    std::optional<int> count;                       // elements
    std::optional<int> period;                      // of auto-events, ms
};
/// own_model is compared by its source.
bool operator==(const ServiceInfo& a, const ServiceInfo& b);

/// The retained `$description` of a board.
struct Description {
    std::string board;
    std::string session;  // random per agent start
    std::uint64_t seq = 0;
    int lease = kDefaultLeaseSeconds;  // seconds
    FirmwareInfo firmware;
    LinkInfo link;
    AgentInfo agent;
    PinsInfo pins;
    std::vector<ServiceInfo> services;

    const ServiceInfo* service(std::string_view name) const;
    friend bool operator==(const Description&, const Description&) = default;
};

nlohmann::json to_json(const Description& description);
/// Compact text of it; what is empty is left out.
std::string to_text(const Description& description);

/// From JSON that anyone may have published. Board, session, seq and services must be there; unknown members
/// are passed over. Fails with "/services/1/name: ..." on wrong types, names that are not valid, texts longer
/// than 256 bytes, two services with one name, or numbers out of bounds.
Expected<Description> description_from_json(const nlohmann::json& document);
Expected<Description> parse_description(std::string_view text);

}  // namespace asip::model
