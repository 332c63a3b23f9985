// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "gateway/export/exported_board.hpp"

namespace asip::gateway::exports {

// A command that another system sends is not longer.
inline constexpr std::size_t kMaxCommandBytes = 4096;
inline constexpr int kMaxCommandDepth = 4;
inline constexpr std::size_t kShownBytes = 60;  ///< of it, in a sentence

/// Boards in the words of another system on the same broker: what is published, and what a message means;
/// Exporter says when. Pure, and the same for the same input.
class Dialect {
  public:
    using Retained = std::map<std::string, std::string>;  ///< topic -> payload

    virtual ~Dialect() = default;

    /// "home-assistant": sends the commands, and names the export on a command line.
    virtual std::string_view by() const = 0;
    /// "Home Assistant"
    virtual std::string_view title() const = 0;
    virtual bool read_only() const = 0;

    // --- where things are

    /// Below it the export keeps its lease.
    virtual std::string base() const = 0;
    std::string lease() const { return base() + "/$lease"; }
    /// The session of each board whose states are retained.
    std::string sessions() const { return base() + "/$sessions"; }
    /// Where its documents begin, which may change with a start.
    virtual std::string place() const = 0;
    /// Filters that find every message this export may have retained at `place`, except below base().
    virtual std::vector<std::string> retained(const std::string& place) const = 0;
    /// Filters for what it retains, which match no command.
    virtual std::vector<std::string> watched() const;
    /// Whether a topic of all that is retained is the export's.
    virtual bool is_ours(const Retained& found, const std::string& topic, const std::string& place) const = 0;

    // --- the gateway

    virtual std::string gateway_state() const = 0;
    virtual std::string online() const { return "online"; }
    virtual std::string leaving() const { return "offline"; }  ///< the gateway ends
    virtual std::string lost() const { return "offline"; }     ///< published by the broker
    /// The state while the document beside it changes; empty: none.
    virtual std::string changing() const { return {}; }
    /// Empty: the gateway has no document.
    virtual std::string gateway_document_topic() const { return {}; }
    virtual std::string gateway_document(const std::vector<std::string>& /*boards*/,
                                         const std::string& /*on_bus*/) const {
        return {};
    }
    /// It names the boards.
    virtual bool lists_boards() const { return false; }
    /// How the gateway stands, retained; empty: not told.
    virtual std::string standing_topic() const { return {}; }
    virtual std::string standing(std::size_t /*boards_online*/) const { return {}; }
    /// Where the other system says "online" when it starts; empty: nowhere.
    virtual std::string status() const { return {}; }

    // --- a board

    /// The board's name in topics.
    virtual std::string id_of(std::string_view board) const { return std::string(board); }
    /// The one board that may have this id: ask id_of().
    virtual std::string name_of(std::string_view id) const { return std::string(id); }
    virtual std::string board_state(std::string_view board) const = 0;
    /// `state`: of the catalogue.
    virtual std::string state_of_board(bool there, std::string_view state) const = 0;
    virtual std::string document_topic(std::string_view board) const = 0;
    struct Document {
        std::string text;
        bool last = true;  ///< false: another one follows some time later
    };
    /// What follows `on_bus`; it may be the same.
    virtual Document next_document(const ExportedBoard& board, const std::string& on_bus) const = 0;
    /// Suffix of the documents that are cleared last: they show which other topics of a board are ours.
    /// Empty: a document is cleared first.
    virtual std::string_view last_cleared() const { return {}; }

    // --- its properties

    virtual std::string state(std::string_view board, const Property& property) const = 0;
    /// Null: unknown. Empty: the topic is cleared.
    virtual std::string state_text(const Property& property, const nlohmann::json& value) const = 0;
    virtual int state_qos() const { return 0; }
    /// What is done with a button, not retained; nothing: the other system has no words for that.
    struct Act {
        std::string topic, text;
    };
    virtual std::optional<Act> act(std::string_view /*board*/, const Property& /*property*/,
                                   property::ButtonAct /*act*/) const {
        return std::nullopt;
    }
    /// Where the future value stands; empty: nowhere.
    virtual std::string target(std::string_view /*board*/, const Property& /*property*/) const { return {}; }
    /// Where the last failed command is told.
    virtual std::string error(std::string_view board) const = 0;
    virtual std::string error_text(const std::string& sentence) const = 0;
    virtual bool error_is_retained() const { return true; }
    /// Where it stands which version of its sketch the board has; empty: nowhere.
    virtual std::string firmware(std::string_view /*board*/) const { return {}; }
    virtual std::string firmware_text(const ExportedBoard& /*board*/) const { return {}; }

    // --- commands

    virtual std::string commands() const = 0;  ///< filter
    /// Topics of commands match devices of others, too.
    virtual bool has_neighbours() const { return false; }
    struct Command {
        std::string board;     ///< as id_of() calls it
        std::string property;  ///< its id
    };
    /// Nothing: it is no topic of a command.
    virtual std::optional<Command> command_of(std::string_view topic) const = 0;
    /// As a value of the property. Fails with a sentence.
    virtual Expected<nlohmann::json> value_of(const Property& property, std::string_view payload) const = 0;

  protected:
    /// BEGIN + "BOARD/ENTITY/set".
    static std::optional<Command> command_below(std::string_view begin, std::string_view topic);
};

Unexpected<std::string> not_taken(const Property& property, std::string_view payload);
/// Nothing: no number, or one with something behind it.
std::optional<double> number_from(std::string_view text);
/// An empty text with room for so many properties.
std::string room_for(std::size_t properties);

/// `text` with `mark` and two hexadecimal digits for each character that is not `plain`. Two texts never
/// become one, if none that stays holds `mark`.
template <class Plain>
std::string escaped_id(std::string_view text, std::string_view mark, Plain plain) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string id;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (plain(c))
            id += c;
        else
            (id += mark) += {kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
    return id;
}

}  // namespace asip::gateway::exports
