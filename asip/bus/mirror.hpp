#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "asip/bus/items.hpp"
#include "asip/bus/query.hpp"
#include "asip/bus/topics.hpp"
#include "asip/model/description.hpp"
#include "asip/model/model_set.hpp"
#include "asip/time.hpp"

namespace asip::bus {

/// What can be told of boards from the service bus alone, without a registry: each board as its retained
/// description and state say, and those that publish only their names. Pure.
class Mirror {
  public:
    explicit Mirror(Topics topics) : topics_(std::move(topics)) {}

    /// Takes a message of the service bus; anything else changes nothing. Returns the board it concerned,
    /// else empty.
    std::string apply(const std::string& topic, const std::string& payload, bool retained, Time now);

    /// Boards whose $description or $state was refused, and why: topic and reason.
    const std::map<std::string, std::string>& refused() const { return refused_; }

    /// Boards by name, ordered. A board said to be online whose description is gone is `lost`: its lease ran
    /// out.
    std::vector<BoardItem> boards(Time now) const;
    std::optional<BoardItem> board(const std::string& name, Time now) const;
    /// Nothing when the board has none.
    const model::Description* description(const std::string& name) const;
    std::vector<std::string> names() const;

  private:
    struct Entry {
        std::string said;
        std::optional<model::Description> description;
        std::string document;
        std::vector<std::string> service_names;
        bool named = false;
        std::optional<Time> heard;  // anything that was not retained
    };
    BoardItem item(const std::string& name, const Entry& entry, Time now) const;
    void take_description(const std::string& topic, Entry& entry, const std::string& name,
                          const std::string& payload);

    Topics topics_;
    std::map<std::string, Entry> entries_;
    std::map<std::string, std::string> refused_;
};

/// A board as a registry would tell of it. Services come in the description's order.
BoardItem board_item(const model::Description& description, std::string said);

/// Whether a board, or one service of it, is among what `query` asks for (sort, limit and cursor aside).
bool board_matches(const Query& query, const BoardItem& board, const model::Description* description,
                   const model::ModelSet& models);
bool service_matches(const Query& query, const ServiceItem& service, const model::Description* description,
                     const model::ModelSet& models);

/// The model of a service: its own, the standard one it refers to (another version of it where this one is
/// unknown), or what letter and title suggest; null when there is none.
model::ModelPtr model_of(const model::ServiceInfo& service, const model::ModelSet& models);

}  // namespace asip::bus
