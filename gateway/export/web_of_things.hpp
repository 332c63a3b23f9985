// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "gateway/export/dialect.hpp"

namespace asip::gateway::exports {

/// Boards as things of the Web of Things: a Thing Description (TD 1.1) for each. Its values are JSON, as
/// those of Property. HTTP serves descriptions and forms; what is published here are the forms of MQTT. Pure.
///
///     ROOT/export/wot/$state                 "online": the gateway exports; its will says "offline"
///     ROOT/export/wot/BOARD/$state           "online", "sleeping", "offline", "lost"
///     ROOT/export/wot/BOARD/PROPERTY         the value, retained
///     ROOT/export/wot/BOARD/PROPERTY/set     what a consumer wants it to be; of an action, that it is
///     invoked ROOT/export/wot/BOARD/$failed          the last command that failed, in words; not retained
class WebOfThings final : public Dialect {
  public:
    struct Options {
        std::string root = "asip";
        bool read_only = false;  ///< nothing can be set over MQTT
    };
    /// In the forms for one asker.
    struct Forms {
        std::string base;              ///< of HTTP: "http://localhost:8080/"
        bool token = false;            ///< HTTP needs one
        bool may_set = true;           ///< over HTTP
        std::string broker;            ///< "mqtt://localhost:1883"; empty: no forms of MQTT
        bool broker_password = false;  ///< it needs one
    };
    static constexpr std::string_view kBoardState = "board-state";
    static constexpr std::string_view kGatewayState = "gateway-state";
    static constexpr std::string_view kFailed = "command-failed";

    explicit WebOfThings(Options options) : options_(std::move(options)) {}

    /// An URN.
    std::string thing_id(std::string_view board) const;
    /// By an id, or by a name.
    std::string board_of(const std::string& id) const;
    nlohmann::json thing(const ExportedBoard& board, const Forms& forms) const;
    /// The thing that is the directory of the others.
    nlohmann::json directory(const Forms& forms) const;

    std::string_view by() const override { return "web-of-things"; }
    std::string_view title() const override { return "Web of Things"; }
    bool read_only() const override { return options_.read_only; }
    std::string base() const override { return options_.root + "/export/wot"; }
    std::string place() const override { return base(); }
    std::vector<std::string> retained(const std::string& /*place*/) const override { return {}; }
    bool is_ours(const Retained& /*found*/, const std::string& topic,
                 const std::string& /*place*/) const override {
        return topic.starts_with(base() + "/");
    }
    std::string gateway_state() const override { return base() + "/$state"; }
    std::string online() const override { return R"("online")"; }
    std::string leaving() const override { return R"("offline")"; }
    std::string lost() const override { return leaving(); }
    std::string board_state(std::string_view board) const override { return topic(board, "$state"); }
    std::string state_of_board(bool there, std::string_view state) const override;
    std::string document_topic(std::string_view /*board*/) const override { return {}; }
    Document next_document(const ExportedBoard& /*board*/, const std::string& /*on_bus*/) const override {
        return {};
    }
    std::string state(std::string_view board, const Property& property) const override {
        return topic(board, property::plain_id(property.id));
    }
    std::string state_text(const Property& property, const nlohmann::json& value) const override;
    std::string error(std::string_view board) const override { return topic(board, "$failed"); }
    std::string error_text(const std::string& sentence) const override;
    bool error_is_retained() const override { return false; }
    std::string commands() const override { return base() + "/+/+/set"; }
    std::optional<Command> command_of(std::string_view topic) const override;
    Expected<nlohmann::json> value_of(const Property& property, std::string_view payload) const override;

  private:
    nlohmann::json described(const ExportedBoard& board, const Property& property, const Forms& forms) const;
    void describe_states(nlohmann::json& thing, const ExportedBoard& board, const Forms& forms) const;
    std::string topic(std::string_view board, std::string_view name) const {
        return base() + "/" + std::string(board) + "/" + std::string(name);
    }

    Options options_;
};

}  // namespace asip::gateway::exports
