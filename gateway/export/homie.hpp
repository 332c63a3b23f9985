// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "gateway/export/dialect.hpp"

namespace asip::gateway::exports {

/// Boards as devices of the Homie convention, version 5. The gateway is the root device, each board its
/// child, each service a node, each property a property. Pure.
///
///     DOMAIN/5/GATEWAY/$state, $description     the gateway; its will says `lost`
///     DOMAIN/5/BOARD/$state, $description       a board
///     DOMAIN/5/BOARD/SERVICE/ENTITY             the value
///     DOMAIN/5/BOARD/SERVICE/ENTITY/set         what a controller wants it to be
///     DOMAIN/5/BOARD/SERVICE/ENTITY/$target     what it is to become
///     DOMAIN/5/BOARD/$log/error                 the last command that failed, in words; not retained
class Homie final : public Dialect {
  public:
    struct Options {
        std::string root = "asip";
        std::string domain = "homie";
        bool read_only = false;  ///< nothing can be set
    };

    explicit Homie(Options options) : options_(std::move(options)) {}

    /// For the first level of all topics.
    static bool valid_domain(std::string_view text);

    std::string_view by() const override { return "homie"; }
    std::string_view title() const override { return "Homie"; }
    bool read_only() const override { return options_.read_only; }
    std::string base() const override { return options_.root + "/export/homie"; }
    std::string place() const override { return options_.domain; }
    std::vector<std::string> retained(const std::string& place) const override { return {place + "/5/#"}; }
    std::vector<std::string> watched() const override {
        const auto begin = options_.domain + "/5/+/+";
        return {base() + "/+", begin, begin + "/+", begin + "/+/$target"};
    }
    /// The devices below the same root device.
    bool is_ours(const Retained& found, const std::string& topic, const std::string& place) const override;
    std::string gateway_state() const override { return topic(gateway_id(), "$state"); }
    std::string online() const override { return "ready"; }
    std::string leaving() const override { return "disconnected"; }
    std::string lost() const override { return "lost"; }
    std::string changing() const override { return "init"; }
    bool lists_boards() const override { return true; }
    std::string gateway_document_topic() const override { return topic(gateway_id(), kDescription); }
    std::string gateway_document(const std::vector<std::string>& boards,
                                 const std::string& on_bus) const override;
    std::string id_of(std::string_view board) const override;
    std::string name_of(std::string_view id) const override;
    std::string board_state(std::string_view board) const override { return topic(id_of(board), "$state"); }
    std::string state_of_board(bool there, std::string_view state) const override;
    std::string document_topic(std::string_view board) const override {
        return topic(id_of(board), kDescription);
    }
    Document next_document(const ExportedBoard& board, const std::string& on_bus) const override;
    std::string_view last_cleared() const override { return "/$description"; }
    std::string state(std::string_view board, const Property& property) const override;
    std::string state_text(const Property& property, const nlohmann::json& value) const override;
    int state_qos() const override { return 1; }
    std::string target(std::string_view board, const Property& property) const override;
    std::string error(std::string_view board) const override { return topic(id_of(board), "$log/error"); }
    std::string error_text(const std::string& sentence) const override { return sentence; }
    bool error_is_retained() const override { return false; }
    std::string commands() const override { return options_.domain + "/5/+/+/+/set"; }
    bool has_neighbours() const override { return true; }
    std::optional<Command> command_of(std::string_view topic) const override;
    Expected<nlohmann::json> value_of(const Property& property, std::string_view payload) const override;

  private:
    static constexpr std::string_view kDescription = "$description";

    std::string gateway_id() const;
    std::string topic(const std::string& id, std::string_view rest) const {
        return options_.domain + "/5/" + id + "/" + std::string(rest);
    }
    std::string document(const ExportedBoard& board, std::int64_t version) const;
    bool settable(const Property& property) const { return property.settable() && !options_.read_only; }

    Options options_;
};

}  // namespace asip::gateway::exports
