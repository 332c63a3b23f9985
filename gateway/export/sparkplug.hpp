// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "gateway/export/exported_board.hpp"
#include "gateway/export/sparkplug_payload.hpp"

namespace asip::gateway::exports {

/// Boards as devices of Sparkplug B 3.0. The gateway is the edge node, each board a device, each property a
/// metric; a light is up to three. Pure: what is said is decided here, when and with which number is not.
///
///     spBv1.0/GROUP/NBIRTH/EDGE, NDEATH/EDGE         the gateway; its will is NDEATH
///     spBv1.0/GROUP/DBIRTH/EDGE/BOARD, DDEATH/..     a board
///     spBv1.0/GROUP/DDATA/EDGE/BOARD                 values, by alias
///     spBv1.0/GROUP/NCMD/EDGE, DCMD/EDGE/BOARD       what a host wants
///     spBv1.0/STATE/HOST                             whether a host is there
class Sparkplug {
  public:
    struct Options {
        std::string root = "asip";
        std::string group;
        std::string edge = "asip";
        std::string host;        ///< the host that is waited for; empty: none
        std::string version;     ///< of the gateway
        bool read_only = false;  ///< nothing can be set
    };
    static constexpr std::string_view kRebirth = "Node Control/Rebirth";

    explicit Sparkplug(Options options) : options_(std::move(options)) {}
    const Options& options() const { return options_; }

    /// For a group, an edge node or a host.
    static bool valid_id(std::string_view text);

    std::string base() const { return options_.root + "/export/sparkplug"; }
    std::string lease() const { return base() + "/$lease"; }
    std::string state() const { return base() + "/$state"; }
    std::string topic(std::string_view kind) const;
    std::string topic(std::string_view kind, std::string_view board) const;
    std::string host_state() const;
    /// Nothing: the topic is no DCMD.
    std::optional<std::string> board_of(std::string_view topic) const;

    /// The part of a value that a metric is.
    enum class Part { kWhole, kOn, kBrightness, kColor };
    struct Slot {
        std::string name;
        Part part = Part::kWhole;
        sparkplug::DataType type = sparkplug::DataType::kString;
        friend bool operator==(const Slot&, const Slot&) = default;
    };
    static std::vector<Slot> slots(const Property& property);
    /// `value`: the property's, null where it is not known. Any JSON may be given.
    static sparkplug::Value value(const Property& property, const Slot& slot, const nlohmann::json& value);
    /// Beside its value, in a birth.
    std::vector<sparkplug::Property> properties(const Property& property, const Slot& slot) const;

    /// Nothing: the text does not say.
    struct HostState {
        bool online = false;
        double timestamp = 0;
    };
    static std::optional<HostState> host_state_from(std::string_view payload);

    struct Wanted {
        Part part;
        sparkplug::Value value;
    };
    /// As a value of the property. `known`: its value now, or null. Fails with a sentence.
    Expected<nlohmann::json> value_of(const Property& property, const std::vector<Wanted>& wanted,
                                      const nlohmann::json& known) const;

    // Metrics of the node.
    static sparkplug::Metric bd_seq(unsigned number, std::uint64_t time_ms);
    std::vector<sparkplug::Metric> node_metrics(unsigned bd_seq, std::uint64_t time_ms) const;

  private:
    Options options_;
};

}  // namespace asip::gateway::exports
