// SPDX-License-Identifier: Apache-2.0
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

/// The view of all boards from the service bus alone, without a registry: each board made of its
/// retained description and state, and those that publish only their names.
///
/// Pure: the caller subscribes to ROOT/servicebus/# and gives every message to apply(), with the time of the
/// program's monotonic clock. It may be kept as long as the subscription; after a lost connection begin with
/// a new one, as the broker does not report what expired meanwhile. Memory is bounded: kMaxBoards boards,
/// each of a description of at most 64 KiB.
///
/// States are effective, as those of a registry: what was reported AND the lease not run out. A lease begins
/// when its description arrives, also a retained one, whose age is unknown: such a board may be listed as
/// online for up to one lease too long. A board that publishes only its names has a lease of 60 s.
class Mirror {
  public:
    static constexpr std::size_t kMaxBoards = 100'000;
    /// How many topics refused() remembers.
    static constexpr std::size_t kMaxRefused = 1000;

    explicit Mirror(Topics topics) : topics_(std::move(topics)) {}

    /// Takes a message; one that is not of the service bus changes nothing. An empty `payload` deletes what
    /// the topic stood for. `retained`: the message was delivered because it is stored, and is no sign of
    /// life. Returns the name of the board that it concerned; empty: none.
    std::string apply(const std::string& topic, const std::string& payload, bool retained, Time now);

    /// Topics whose last message could not be used, with the reason. A valid message removes its entry.
    const std::map<std::string, std::string>& refused() const { return refused_; }

    /// All boards in the order of their names. A board whose state is "online" and whose description is gone
    /// is "lost": its lease ran out.
    std::vector<BoardItem> boards(Time now) const;
    /// One of them; nothing when there is no such board.
    std::optional<BoardItem> board(const std::string& name, Time now) const;
    /// The description of a board; null when it has none. Valid until the next apply().
    const model::Description* description(const std::string& name) const;
    /// In order.
    std::vector<std::string> names() const;

  private:
    struct Entry {
        std::string reported;
        std::optional<model::Description> description;
        std::string document;
        std::vector<std::string> service_names;
        bool named = false;
        std::optional<Time> heard;  // anything that was not retained
        Time lease_end{};           // of the description, else of the names
    };
    void refuse(const std::string& topic, std::string reason);
    BoardItem item(const std::string& name, const Entry& entry, Time now) const;
    void take_name(Entry& entry, Time now);
    void take_state(const std::string& topic, Entry& entry, const std::string& payload);
    void take_description(const std::string& topic, Entry& entry, const std::string& name,
                          const std::string& payload, Time now);

    Topics topics_;
    std::map<std::string, Entry> entries_;
    std::map<std::string, std::string> refused_;
};

/// A board as a registry would list it, of the description alone: no times. `reported`: its state, empty for
/// "online". Services come in the order of the description.
BoardItem board_item(const model::Description& description, std::string reported);

/// Whether a board, or one service of it, is among what `query` asks for (sort, limit and cursor aside). The
/// rule is that of match.hpp. `description` may be null; `models` gives the units of standard models.
bool board_matches(const Query& query, const BoardItem& board, const model::Description* description,
                   const model::ModelSet& models);
bool service_matches(const Query& query, const ServiceItem& service, const model::Description* description,
                     const model::ModelSet& models);

/// The model of a service: its own, the standard one it refers to (another version of it where this one is
/// unknown), or what letter and title suggest; null when there is none.
model::ModelPtr model_of(const model::ServiceInfo& service, const model::ModelSet& models);

}  // namespace asip::bus
