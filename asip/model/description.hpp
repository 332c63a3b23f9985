// SPDX-License-Identifier: Apache-2.0
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
#include "asip/model/board_state.hpp"
#include "asip/model/labels.hpp"
#include "asip/model/service_model.hpp"
#include "asip/protocol/extensions.hpp"

namespace asip::model {

// Bounds of a `$description`; a larger one is refused by every reader.
inline constexpr std::size_t kMaxDescriptionBytes = std::size_t{64} * 1024;
inline constexpr std::size_t kMaxDescriptionServices = 64;
inline constexpr std::size_t kMaxFaultBytes = 2048;
inline constexpr std::size_t kMaxWarnings = 8;
inline constexpr std::size_t kMaxWarningBytes = 1024;
inline constexpr std::size_t kMaxStopBytes = 256;
inline constexpr int kDefaultLeaseSeconds = 60;
inline constexpr int kMaxLeaseSeconds = 24 * 60 * 60;

/// From the board's answers. Texts have at most 256 bytes of UTF-8 without control characters; empty:
/// unknown, and left out in JSON.
struct FirmwareInfo {
    std::string protocol;  ///< "0.4"
    std::string chip;
    std::string sketch;
    protocol::Extensions extensions;
    std::string version{};    ///< of the firmware library in the sketch: "0.2"
    std::string available{};  ///< the newer one that its agent would load: the board is out of date
    friend bool operator==(const FirmwareInfo&, const FirmwareInfo&) = default;
};

struct LinkInfo {
    std::string kind;  ///< "serial", "tcp", "sim", ...
    std::string path;  ///< port, or host:port
    int baud = 0;      ///< 0: does not apply
    friend bool operator==(const LinkInfo&, const LinkInfo&) = default;
};

struct AgentInfo {
    std::string version;
    std::string host;    ///< name of its machine
    std::string client;  ///< MQTT client id
    friend bool operator==(const AgentInfo&, const AgentInfo&) = default;
};

/// The values come only while a program demands them (bus/demand.hpp). In milliseconds, 0 to 65535.
struct OnDemandInfo {
    int fastest = 0;  ///< period that demands can bring a service to
    int resting = 0;  ///< period while no program demands values; 0: it does not report then
    friend bool operator==(const OnDemandInfo&, const OnDemandInfo&) = default;
};

/// The board was stopped and takes no commands until it is resumed.
struct StopInfo {
    std::string by;     ///< the name that the sender of the stop gave
    std::string why;    ///< in the sender's words
    std::string since;  ///< time of day by the agent's clock
    friend bool operator==(const StopInfo&, const StopInfo&) = default;
};

/// The digital pins: a character each, from pin 0 on; an empty text is unknown.
struct PinsInfo {
    std::string capabilities;  ///< a digit, the sum of 1 digital, 2 analog in, 4 PWM
    std::string owners;        ///< service letter, '@' system, '-' none
    std::string modes;         ///< the digit of protocol::PinMode
    /// Pin and analog channel, ascending by pin.
    std::vector<std::pair<std::uint8_t, std::uint8_t>> analog;

    bool empty() const { return capabilities.empty() && owners.empty() && modes.empty() && analog.empty(); }
    friend bool operator==(const PinsInfo&, const PinsInfo&) = default;
};

struct ServiceInfo {
    std::string name;   ///< on the bus, unique on the board: the model's name, or the letter
    char id = 0;        ///< its letter; 0: unknown
    std::string model;  ///< "distance@1"; empty: no model, or `own_model`
    /// In full, where not every program has it built in; null for standard ones.
    std::shared_ptr<const ServiceModel> own_model;
    std::string title;          ///< the board's friendly name
    std::optional<int> count;   ///< number of elements, 0 to 65535
    std::optional<int> period;  ///< of its auto-event in milliseconds, 0 to 65535; 0: off
};
/// By the sources of own models.
bool operator==(const ServiceInfo& a, const ServiceInfo& b);

/// A retained `$description`: all that an agent announces, on each change and in time for the lease.
struct Description {
    std::string board;
    std::string session;               ///< random, new with each start of the agent
    std::uint64_t seq = 0;             ///< counts the descriptions of a session
    int lease = kDefaultLeaseSeconds;  ///< seconds, 1 to kMaxLeaseSeconds, after which it no longer holds
    FirmwareInfo firmware;
    LinkInfo link;
    AgentInfo agent;
    PinsInfo pins;
    std::vector<ServiceInfo> services;
    Labels labels;
    /// Why kept labels are missing; empty: none are. At most kMaxFaultBytes.
    std::string labels_fault{};
    /// What its agent finds doubtful about the board, for people. At most kMaxWarnings.
    std::vector<std::string> warnings{};
    /// When this was published. None: its agent says states on `$state` alone.
    std::optional<SaidState> state{};
    std::optional<OnDemandInfo> on_demand{};  ///< none: it reports whether or not anybody listens
    std::optional<StopInfo> stopped{};        ///< none: it takes commands

    /// Null: none. Valid while `services` is not changed.
    const ServiceInfo* service(std::string_view name) const;
    friend bool operator==(const Description&, const Description&) = default;
};

nlohmann::json to_json(const Description& description);
/// Compact; what is empty is left out.
std::string to_text(const Description& description);

/// From JSON that anyone may have published. Board, session, seq and services are required; unknown members
/// are passed over. Fails with the first fault and its place, "/services/1/name: is not a valid name".
Expected<Description> description_from_json(const nlohmann::json& document);
/// Fails also on more than kMaxDescriptionBytes, nesting above 16, or no JSON.
Expected<Description> parse_description(std::string_view text);

}  // namespace asip::model
