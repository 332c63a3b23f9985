// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/label_selector.hpp"
#include "asip/bus/request/demander.hpp"
#include "asip/bus/topics.hpp"
#include "asip/property/documents.hpp"
#include "registry/catalogue_types.hpp"
#include "registry/port.hpp"
#include "registry/values/recorder.hpp"

namespace asip::registry {

/// Which properties are to be kept: those whose pin or service has a name, those on a dashboard, and those
/// that a pattern BOARD/PROPERTY matches. Reads how they stand from `$values` of their boards, and of no
/// others. A property has a value while its board is there and its agent says one. Pure.
class ValueChoice {
  public:
    struct Options {
        std::vector<std::string> patterns;
        double demand_hz = 0;  ///< 0: nothing is demanded
    };
    struct Handlers {
        std::function<void(const PropertyKey& key, double value)> set;  ///< kGap: there is none
        std::function<void(const PropertyKey& key)> drop;               ///< it is kept no longer
        std::function<std::optional<bus::BoardItem>(const std::string& board)> look;
    };
    static constexpr std::size_t kMaxLooks = 500;  ///< at boards, in one tick
    static constexpr std::size_t kMaxDashboards = 64;

    ValueChoice(const bus::Topics& topics, Options options, Port port, bus::Demander demander,
                Handlers handlers);

    std::string dashboards() const { return dashboard_prefix_ + "+"; }
    void connected(Time now);
    /// All that the broker retains has come: a dashboard that has not is gone.
    void complete(const std::function<std::vector<std::string>()>& each);
    void disconnected() { demander_.disconnected(); }
    /// The connection that brings values: nothing is known until what is retained has come again.
    void values_lost();
    /// Something about it changed.
    void changed(const std::string& board) { to_look_.insert(board); }
    /// True: the message is a dashboard. `each`: every board that is known.
    bool dashboard(const mqtt::Message& message, const std::function<std::vector<std::string>()>& each);
    /// `$values` of a board. Any bytes may be given.
    void values(const std::string& board, std::string_view payload);
    void description(const mqtt::Message& message, Time now);
    /// Call ten times a second, while connected.
    void tick(Time now);

  private:
    struct Shown {
        std::string board;
        std::optional<bus::LabelSelector> labels;
        std::string property;
        friend bool operator==(const Shown&, const Shown&) = default;
    };
    struct Said {
        double value = kGap;
        std::optional<bool> chosen{};  // nothing: not looked at
        bool kept = false;
    };
    struct Board {
        bool there = false;
        std::string session;  // of its description
        model::Labels labels;
        property::DocumentHead head;       // of the values
        std::map<std::string, Said> said;  // by the values
        std::map<std::string, bus::Demander::Want> wants;
    };
    bool is_shown(const Shown& shown, const std::string& name, const Board& board) const;
    bool is_wanted(const std::string& name, const Board& board) const;
    bool is_chosen(const std::string& name, const Board& board, const std::string& id) const;
    void look(const std::string& name);
    void apply(const std::string& name, Board& board);
    void leave(const std::string& name);

    bus::Topics topics_;
    Options options_;
    Port port_;
    bus::Demander demander_;
    Handlers handlers_;
    std::string dashboard_prefix_;
    std::map<std::string, std::vector<Shown>> dashboards_;
    std::set<std::string> came_;           // dashboards, since the connection
    std::map<std::string, Board> boards_;  // whose values are subscribed to
    std::set<std::string> to_look_;
};

}  // namespace asip::registry
