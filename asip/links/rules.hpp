// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "asip/links/link.hpp"
#include "asip/property/contact.hpp"
#include "asip/time.hpp"

namespace asip::links {

/// What is remembered of a link when its agent ends.
struct Kept {
    /// What the source made of the target last: true, false or a number; null: nothing. A link that toggles
    /// keeps how the target stood last.
    nlohmann::json seen{};
    bool suspended = false;  ///< another client set the target since then
    bool over = false;       ///< Link::lasts is over, or its command was sent
    friend bool operator==(const Kept&, const Kept&) = default;
};

/// What is to be done.
struct Order {
    enum class Kind { kSet, kCommand, kSafe };
    std::string link;
    Kind kind = Kind::kSet;
    nlohmann::json value{};  ///< of kSet
    std::string because;     ///< "desk/io/2 was on"
};

/// The links of one board: what its sources, its targets, other clients and time do goes in; orders come out.
/// Pure.
///
/// A level link sends one command for each change of its source, and one more when the target is back with
/// another value; none while another client's command stands. An event link sends one for each event, and
/// never makes up for one.
class Rules {
  public:
    static constexpr std::size_t kMaxASecond = 20;              ///< commands of one link
    static constexpr Duration kGone = std::chrono::seconds(1);  ///< a source that is away so long is not
                                                                ///< there

    struct World {
        /// How the target stands; nothing: not known.
        std::function<std::optional<nlohmann::json>(const std::string& target)> value;
        /// Whether the board takes commands now.
        std::function<bool()> ready;
        /// By the clock on the wall, of the day.
        std::function<int()> second_of_day;
        /// Whether the target is to be made safe when its source is not there.
        std::function<bool(const Link&)> dangerous;
    };
    explicit Rules(World world) : world_(std::move(world)) {}

    struct Entry {
        Link link;
        Kept kept{};
        std::string cause{};  ///< what it did last, and why
      private:
        friend class Rules;
        std::optional<nlohmann::json> source{};  // as it is now; nothing: not known
        bool heard = false;                      // in this life
        bool tried = false;                      // nothing more is sent for the present value
        int in_flight = 0;
        std::optional<nlohmann::json> sent{};  // while in flight
        int events = 0;                        // that are due then
        std::optional<Time> due{};             // of `after`
        std::optional<Time> until{};           // of `lasts`
        std::optional<Time> gone{};            // when the source counts as not there; Time::max(): it does
        bool released = false;                 // the target was made safe therefore
        std::deque<Time> times{};              // of the commands of the last second
    };

    /// New, or anew: what was known of its source is heard again.
    void set(Link link, Kept kept, Time now);
    void remove(const std::string& name);
    void enable(const std::string& name, bool enabled);
    const std::map<std::string, Entry>& links() const { return links_; }

    // --- what happens
    /// A source stands so; nothing: not known now, which changes nothing.
    void source(std::string_view board, std::string_view id, const std::optional<nlohmann::json>& value,
                Time now);
    void act(std::string_view board, std::string_view id, property::ButtonAct act, Time now);
    /// Whether the board of a source can be heard.
    void present(std::string_view board, bool is, Time now);
    /// The board of the targets is there (again): it may stand otherwise than before.
    void target_back();
    /// The board executed a command of another client, or perhaps did, that sets this property. `link`: that
    /// client is the link; empty: it is none.
    void executed(const std::string& target, std::string_view link);
    /// The board was told to stop, and is stopped while `latched`.
    void stopped(bool latched);
    void resumed() { stopped_ = false; }
    /// One command of this link ended; `text`: why it failed.
    void finished(const std::string& link, bool ok, const std::string& text);

    /// What is due. To be called after the others, and when next_deadline() has come.
    std::vector<Order> run(Time now);
    std::optional<Time> next_deadline() const;
    /// Links of which Entry::kept, or `cause`, is another one than at the last call.
    std::set<std::string> take_changed() { return std::exchange(changed_, {}); }

  private:
    bool in_time(const Link& link) const;
    nlohmann::json output(const Entry& entry) const;
    static nlohmann::json wanted(const Link& link, const nlohmann::json& output, bool over);
    void look(Entry& entry, Time now);
    void make(Entry& entry, Time now, std::vector<Order>& orders, bool ends = false);
    void fire(Entry& entry, Time now, std::vector<Order>& orders);
    void finish(Entry& entry, Time now, std::vector<Order>& orders);
    void release(Entry& entry, Time now, std::vector<Order>& orders);
    void look_at_clock(const std::pair<int, int>& between, Time now);
    bool may_send(Entry& entry, Time now);
    void send(Entry& entry, Order order, Time now, std::vector<Order>& orders);
    void suspend(Entry& entry, const std::string& why);
    void say(Entry& entry, std::string cause);
    void keep(Entry& entry, Kept kept);

    World world_;
    std::map<std::string, Entry> links_;
    std::set<std::string> changed_;
    bool stopped_ = false;
    bool was_there_ = false;        // the board of the targets, in this life
    std::optional<Time> clock_at_;  // the clock on the wall is looked at
};

}  // namespace asip::links
