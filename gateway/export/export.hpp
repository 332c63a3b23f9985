// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/request/demander.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"
#include "gateway/export/exported_board.hpp"
#include "gateway/export/turn.hpp"

namespace asip::gateway::exports {

/// Shows boards to another system on the same broker, over a connection of its own, which is there only while
/// this gateway holds the lease. Pure.
class Export {
  public:
    struct Present {
        bool there = false;                          ///< it can be commanded
        std::shared_ptr<const ExportedBoard> board;  ///< exports share it
        std::string state{};                         ///< of the catalogue
        std::string session{};                       ///< of its agent
    };
    struct Port {
        std::function<void()> connect;     ///< the export's own connection, with its will
        std::function<void()> disconnect;  ///< it ends when all is sent
        // Over that connection:
        std::function<void(mqtt::Message)> publish;
        std::function<bool()> has_room;  ///< more may be published now
        std::function<void()> again;     ///< sent() is called once others had their turn
        std::function<void()> discard;   ///< what waits to be published is forgotten
        std::function<void(const std::string& filter)> subscribe;
        /// To what others publish from now on, across connections.
        std::function<void(const std::string& filter)> watch;
        std::function<void(const std::string& filter)> unsubscribe;
        // What the gateway does:
        std::function<bool()> ready;  ///< the catalogue holds all that is on the bus
        std::function<std::vector<std::string>()> boards;
        std::function<std::optional<Present>(const std::string& board)> board;
        /// Null: unknown. Nothing: nobody says.
        std::function<std::optional<nlohmann::json>(const std::string& board, const Property&)> value;
        /// Counts values that their properties cannot have.
        std::function<void(std::uint64_t)> refused;
        std::function<bus::Demander::Want(const std::string& board, const std::string& service, double hz)>
            want;
        /// `done` is called once, with a sentence where the command failed.
        std::function<void(const std::string& board, const Request&, std::function<void(std::string)> done)>
            command;
        std::function<void(const std::string& sentence)> log;
        std::function<std::int64_t()> wall_ms;  ///< since 1970, of the machine's clock
    };

    virtual ~Export() = default;

    /// It sends the commands, and names the export on a command line: "home-assistant".
    virtual std::string_view by() const = 0;
    virtual std::string_view title() const = 0;
    /// Over the gateway's connection.
    virtual std::vector<std::string> subscriptions() const = 0;
    /// Over the export's own connection, from its start.
    virtual std::vector<std::string> own_subscriptions() const = 0;
    /// For the next connection of the export, while there is one; nothing: no will.
    virtual std::optional<mqtt::Message> will() const = 0;

    // Over the gateway's connection:
    virtual void subscribed(Time now) = 0;
    virtual void disconnected() = 0;
    virtual void message(const mqtt::Message& message, Time now) = 0;
    /// They came, changed, or were forgotten.
    virtual void changed(std::set<std::string> boards, Time now) = 0;
    /// A service reported something.
    virtual void value(std::string_view board, std::string_view service, std::string_view json, Time now) = 0;
    /// The board's agent said how these properties stand, by id; none: all of them.
    virtual void known(const std::string& board, const std::vector<std::string>& ids, Time now) = 0;

    /// Something was done with a button.
    virtual void acted(const std::string& /*board*/, const std::string& /*id*/, property::ButtonAct /*act*/) {
    }

    // Over the export's own:
    /// It is there, with the will that will() said before; will() says the one of the next connection now.
    virtual void own_connected() {}
    /// Little waits to be sent any more. What is published is made in slices, so that a broker works on one
    /// while the next is made, and little stands in front of what is newer.
    virtual void sent(Time /*now*/) {}
    /// All that is subscribed to is granted: after each connection, and after each further subscription.
    virtual void own_subscribed(Time now) = 0;
    virtual void own_disconnected() = 0;
    virtual void own_message(const mqtt::Message& message, Time now) = 0;

    /// Call ten times a second.
    virtual void tick(Time now) = 0;
    /// The program ends: what is exported is not available any more.
    virtual void leave() = 0;
    /// It shows boards now.
    virtual bool active() const = 0;
    /// Which gateway exports.
    virtual const Turn& turn() const = 0;
    /// Nothing is exported, and all that was is cleared.
    virtual bool finished() const = 0;
};

/// Makes an export once there is something that it can be connected with.
using MakeExport = std::function<std::unique_ptr<Export>(Random, Export::Port)>;

}  // namespace asip::gateway::exports
