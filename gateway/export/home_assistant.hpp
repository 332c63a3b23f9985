// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "gateway/export/dialect.hpp"

namespace asip::model {
class ObjectText;
}

namespace asip::gateway::exports {

using model::ObjectText;

/// Boards in the dialect of Home Assistant: one discovery document for each board, a state topic for each of
/// its properties. Pure: what is published is decided here, when is not.
///
///     PREFIX/device/ID/config             the document, retained
///     PREFIX/device/ROOT_gateway/config   the document of the gateway
///     ROOT/export/ha/$gateway             {"boards":3,"started":"2026-11-27T09:00:00.000Z"}
///     ROOT/export/ha/$state               online: the gateway exports; its will says offline
///     ROOT/export/ha/BOARD/$state         online: the board is there
///     ROOT/export/ha/BOARD/ENTITY         the value
///     ROOT/export/ha/BOARD/ENTITY/set     what Home Assistant wants it to be
///     ROOT/export/ha/BOARD/ENTITY--event  of a button: {"event_type":"press"}, not retained
///     ROOT/export/ha/BOARD/last-error     the last command that failed, in words
class HomeAssistant final : public Dialect {
  public:
    struct Options {
        std::string root = "asip";
        std::string prefix = "homeassistant";
        std::string version;      ///< of the gateway
        std::string started;      ///< when it did, as in ISO 8601; may be empty
        std::string page;         ///< its address, "http://10.0.0.2:8080/"; empty: it is not known
        bool read_only = false;   ///< nothing can be set
        bool entity_ids = false;  ///< propose the ids of properties: sensor.uno1_distance_0
    };
    static constexpr std::size_t kMaxStateBytes = 255;  ///< Home Assistant takes no longer state
    static constexpr std::string_view kLastError = "last-error";
    static constexpr std::string_view kFirmware = "firmware--update";  ///< as no property is called

    explicit HomeAssistant(Options options) : options_(std::move(options)) {}
    const Options& options() const { return options_; }

    std::string_view by() const override { return "home-assistant"; }
    std::string_view title() const override { return "Home Assistant"; }
    bool read_only() const override { return options_.read_only; }
    std::string base() const override { return options_.root + "/export/ha"; }
    std::string place() const override { return options_.prefix; }
    std::vector<std::string> retained(const std::string& place) const override {
        return {place + "/device/+/config"};
    }
    bool is_ours(const Retained& found, const std::string& topic, const std::string& place) const override;
    /// Whether a topic is the document of some board of this bus, or of its gateway.
    bool is_document(const std::string& topic, const std::string& place) const;
    std::string gateway_state() const override { return base() + "/$state"; }
    std::string gateway_document_topic() const override {
        return options_.prefix + "/device/" + gateway_id() + "/config";
    }
    std::string gateway_document(const std::vector<std::string>& boards,
                                 const std::string& on_bus) const override;
    std::string standing_topic() const override { return base() + "/$gateway"; }
    std::string standing(std::size_t boards_online) const override;
    std::string status() const override { return options_.prefix + "/status"; }
    std::string board_state(std::string_view board) const override {
        return base() + "/" + std::string(board) + "/$state";
    }
    std::string state_of_board(bool there, std::string_view /*state*/) const override {
        return there ? "online" : "offline";
    }
    std::string document_topic(std::string_view board) const override;
    Document next_document(const ExportedBoard& board, const std::string& on_bus) const override;
    std::string state(std::string_view board, const Property& property) const override {
        return state(board, property::plain_id(property.id));
    }
    std::string state(std::string_view board, std::string_view property) const {
        return base() + "/" + std::string(board) + "/" + std::string(property);
    }
    std::optional<Act> act(std::string_view board, const Property& property,
                           property::ButtonAct act) const override;
    std::string error(std::string_view board) const override { return state(board, kLastError); }
    std::string error_text(const std::string& sentence) const override { return cut(sentence); }
    std::string firmware(std::string_view board) const override { return state(board, kFirmware); }
    std::string firmware_text(const ExportedBoard& board) const override;
    std::string commands() const override { return base() + "/+/+/set"; }

    /// Which properties are in a document: component -> platform.
    using Components = std::map<std::string, std::string>;
    /// Those of `removed` are named by their platform alone.
    std::string document(const ExportedBoard& board, const Components& removed = {}) const;
    Components components(const ExportedBoard& board) const;
    /// Those of a document as it is on the bus, without those that it removes; any text may be given.
    static Components components_of(std::string_view document);
    /// The document in which those of `old` that are no longer there, or have another platform, are named by
    /// their platform alone: so Home Assistant removes them. Publish it, and document() some time later.
    /// Empty: none is to be removed.
    std::string removing_document(const ExportedBoard& board, const Components& old) const;

    /// The beginning of a text that is longer than a state may be.
    static std::string cut(std::string text);
    /// The value of an property for its state topic; null: it is not known. Empty: the topic is cleared.
    std::string state_text(const Property& property, const nlohmann::json& value) const override;

    /// Nothing: it is no topic of a command.
    std::optional<Command> command_of(std::string_view topic) const override;
    /// What Home Assistant asks for, as a value of the property. Fails with a sentence.
    Expected<nlohmann::json> value_of(const Property& property, std::string_view payload) const override;

  private:
    void describe_device(ObjectText& document, const ExportedBoard& board, const std::string& id) const;
    void describe_component(ObjectText& component, const ExportedBoard& board, const std::string& device,
                            const Property& property) const;
    void describe_events(ObjectText& component, const ExportedBoard& board, const std::string& device,
                         const Property& property) const;
    void describe_firmware(ObjectText& components, const ExportedBoard& board) const;
    std::string platform(const Property& property) const;
    bool shown(const Property& property) const;
    std::string root_id() const;       ///< the root, in characters that ids may hold
    std::string device_begin() const;  ///< of the ids of boards
    std::string device_id(std::string_view board) const;
    std::string gateway_id() const;  ///< that no board has
    void describe_origin(ObjectText& document) const;

    Options options_;
};

/// A unit as Home Assistant writes it, and the class of device where it has one that takes this unit.
struct DeviceClass {
    std::string unit, device_class;
};
DeviceClass device_class_of(std::string_view quantity, std::string_view unit);

/// What the number measures: by its meaning, else by its model.
std::string_view quantity_of(const Property& property);
/// What people said that a pin is, where its platform has a word for it.
void describe_class(ObjectText& component, std::string_view platform, const model::Meaning& meaning);
void describe_unit(ObjectText& component, const Property& property);

}  // namespace asip::gateway::exports
