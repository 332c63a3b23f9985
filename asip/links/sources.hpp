// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "asip/bus/request/demander.hpp"
#include "asip/bus/topics.hpp"
#include "asip/catalogue/bus_view.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/property/documents.hpp"
#include "asip/random.hpp"
#include "asip/time.hpp"

namespace asip::links {

/// What a source did.
struct Told {
    enum class Kind {
        kValue,    ///< it stands so; no `value`: not known
        kAct,      ///< a button, or a property that is on and off like one
        kPresent,  ///< its board is there; not: `is` is false
    };
    Kind kind = Kind::kValue;
    std::string board;
    std::string id{};
    std::optional<nlohmann::json> value{};
    property::ButtonAct act = property::ButtonAct::kPress;
    bool is = false;
};

/// The sources of links, as their agents tell them over the bus, or in this process. An act is told once,
/// whatever is repeated, and never one of before. Pure.
class Sources {
  public:
    using Id = std::pair<std::string, std::string>;  ///< board, and id of a property
    using Tolds = std::vector<Told>;

    /// `user`: of the broker, may be empty.
    Sources(const bus::Topics& topics, const std::string& user, const std::string& client,
            const Random& random);

    Tolds want(const std::set<Id>& sources, Time now);
    /// Boards that links have as sources.
    bool has(std::string_view board) const { return boards_.contains(board); }
    /// What is to be subscribed to, at QoS 1. Of a board of this process only its description.
    std::set<std::string> filters() const;
    /// Rises when filters() may be others.
    std::uint64_t changes() const { return changes_; }

    // Each returns what is new by it, in order.
    Tolds take(const mqtt::Message& message, Time now);
    /// A board of this process, which needs no bus. From then on what the bus says of it does not count.
    Tolds local(const std::vector<property::Property>& properties, const property::ValueDocument& values,
                bool present, Time now);
    Tolds local_gone(const std::string& board);
    void connected(Time now);
    Tolds disconnected();
    Tolds tick(Time now);
    /// `may_publish`: demands can leave.
    std::optional<Time> next_deadline(bool may_publish) const;

    /// Demands that are to be published now.
    std::vector<mqtt::Message> demands(Time now) { return demander_.due(now); }

    /// Null: not known.
    const std::vector<property::Property>* properties(std::string_view board) const;
    std::optional<nlohmann::json> value(const Id& source) const;
    bool is_present(std::string_view board) const;

  private:
    struct Known {
        std::optional<nlohmann::json> value{};
        std::optional<Time> reported{};  // when a report said it
        const property::Property* property = nullptr;
        bus::Demander::Want want{};
    };
    struct Board {
        std::map<std::string, Known> known;  // by id
        std::vector<property::Property> properties;
        property::DocumentHead list, head;
        std::optional<property::ValueDocument> values;  // the last one, with what was reported since
        std::uint64_t last_act = 0;
        bool based = false;  // acts behind last_act are new
        bool present = false;
        bool is_local = false;
    };
    using Boards = std::map<std::string, Board, std::less<>>;

    void use(const std::string& name, Board& board, std::vector<property::Property> properties);
    void take_list(const std::string& name, Board& board, const mqtt::Message& message);
    void take_values(const std::string& name, Board& board, const mqtt::Message& message, Time now,
                     Tolds& told);
    void take_report(const std::string& name, Board& board, std::string_view service,
                     const mqtt::Message& message, Time now, Tolds& told);
    void tell(const std::string& name, Board& board, Time now, bool past, Tolds& told);
    static void deliver(const std::string& name, const std::string& id, Known& known,
                        const std::optional<nlohmann::json>& value, bool edges, Tolds& told);
    static void set_present(const std::string& name, Board& board, bool present, Tolds& told);
    void judge(const std::string& name, Board& board, Time now, Tolds& told);

    const bus::Topics& topics_;
    bus::Demander demander_;
    catalogue::BusView view_;
    Boards boards_;
    std::uint64_t changes_ = 1;
};

}  // namespace asip::links
