// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "agent/counts/allowance.hpp"
#include "agent/inbound/inbound.hpp"
#include "agent/links/link_files.hpp"
#include "agent/reports/board_values.hpp"
#include "asip/links/rules.hpp"
#include "asip/links/sources.hpp"

namespace asip::agent {

/// The links of the board: set over the bus, kept on the disk, shown on `$links`, and executed. Pure: it says
/// in the effects what to write and publish, and which commands are to be executed.
class LinkBook {
  public:
    static constexpr Duration kBetweenShown = std::chrono::milliseconds(500);
    /// A disk is not written for each number that a source reports, nor for each change of a contact.
    static constexpr Duration kBetweenWrites = std::chrono::seconds(10);
    static constexpr Duration kBetweenFlips = std::chrono::seconds(1);
    /// Changes that are not on the disk yet; and as many times what links remember. More are refused, or
    /// wait.
    static constexpr std::size_t kMaxUnwritten = links::kMaxLinks;

    static constexpr Duration kOldPress = std::chrono::seconds(2);
    static constexpr Duration kCatchingUp = std::chrono::seconds(1);

    struct World {
        const Board& board;
        const BoardValues& values;
        std::function<bool()> ready;  ///< the board takes commands, and is safe
        std::string user;             ///< of the broker, may be empty
        std::function<int()> second_of_day;
    };
    LinkBook(World world, const Random& random);

    void load(LinkFiles::Loaded loaded, bool stopped, Time now, Effects& out);
    /// There are some, or something of them is to be told.
    bool any() const { return !rules_.links().empty() || show_at_.has_value(); }

    // --- the bus
    /// False: it was refused.
    bool request(const LinkRequest& request, Time now, Effects& out);
    /// What became of Effects::keep_links.
    void kept(std::uint64_t ticket, const Expected<void>& result, Time now, Effects& out);
    bool has_source(std::string_view board) const { return sources_.has(board); }
    /// What the connection for sources subscribes to.
    std::set<std::string> filters() const;
    std::uint64_t filter_changes() const { return sources_.changes(); }
    void take(const mqtt::Message& message, Time now) { hear(sources_.take(message, now), now); }
    void sources_connected(Time now) { sources_.connected(now); }
    void sources_disconnected(Time now) { hear(sources_.disconnected(), now); }
    /// What is shown is published again.
    void connected(Time now);

    /// The process did not run since then: what was pressed meanwhile, and waited, does nothing.
    void not_watched(Time since, Time now) {
        if (now - since >= kOldPress) old_until_ = now + kCatchingUp;
    }

    // --- boards of this process, and this one
    void local(const std::vector<property::Property>& properties, const property::ValueDocument& values,
               bool present, Time now) {
        hear(sources_.local(properties, values, present, now), now);
    }
    void local_gone(const std::string& board, Time now) { hear(sources_.local_gone(board), now); }

    // --- the board
    void target_back() { rules_.target_back(); }
    /// Another client's command (or that of a link) sets these properties.
    void executed(const std::vector<std::string>& targets, const std::string& link);
    void stopped(bool latched) { rules_.stopped(latched); }
    void resumed() { rules_.resumed(); }
    void finished(const std::string& link, const bus::Reply& reply);

    /// Commands that are due.
    std::vector<Command> run(Time now);
    /// What waits to be written is due now.
    void hurry(Time now) {
        for (auto& [name, at] : write_at_)
            at = now;
    }
    /// Writes and publishes what changed. `may_publish`: the bus is there, and the name ours.
    void tell(bool may_publish, Time now, Effects& out);
    /// Demands for values of this board, which the broker would not bring back.
    std::vector<mqtt::Message> take_own_demands() { return std::exchange(own_demands_, {}); }
    std::optional<Time> next_deadline(bool may_publish) const;

  private:
    struct Asked {
        bus::ReplyTo reply;
        std::string name;
        std::string answer;
        std::optional<KeptLink> before;  // to be as it was, where it cannot be kept
    };
    struct Open {
        std::size_t orders = 0, commands = 0;
        std::string failure;
    };

    std::string why_not(const links::Link& link) const;
    std::vector<std::string> names_of(const std::string& user) const;
    std::string set(const LinkRequest& request, const nlohmann::json& wanted, Time now, Effects& out);
    std::string change(const LinkRequest& request, std::string_view what, const nlohmann::json& name,
                       Time now, Effects& out);
    void begin(Asked asked, const std::string& text, Effects& out);
    void show_soon(Time now);
    void put(KeptLink link, Time now);
    void hear(const links::Sources::Tolds& told, Time now);
    void use_sources(Time now);
    void add_commands(const links::Order& order, Time now, std::vector<Command>& commands);
    Command command(const links::Order& order, const std::string& service, std::string payload,
                    Time now) const;
    std::string safe_line(const links::Link& link) const;
    bool is_held(const links::Link& link) const;
    const property::Property* target(std::string_view id) const;
    bool something_to_show() const;
    std::string document() const;

    World world_;
    links::Sources sources_;
    links::Rules rules_;
    std::vector<std::string> set_aside_;
    std::map<std::string, std::string> written_, caused_;  // by name: the file; when it did something last
    std::map<std::string, std::string> causes_;
    std::map<std::string, Time> write_at_, wrote_;
    std::map<std::string, Open> open_;
    std::map<std::uint64_t, Asked> asked_;
    std::uint64_t ticket_ = 0;
    std::size_t unwritten_ = 0;  // what links remember, on its way to the disk
    Allowance refusals_{20, 1};  // that are logged
    std::optional<Time> show_at_, shown_at_;
    std::optional<Time> old_until_;  // what is heard was done while the process did not run
    std::vector<mqtt::Message> own_demands_;
};

}  // namespace asip::agent
