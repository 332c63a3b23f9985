// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "asip/mqtt/message.hpp"
#include "asip/time.hpp"
#include "gateway/dashboard/dashboard.hpp"

namespace asip::gateway {

/// The dashboards that are retained on the bus, at ROOT/export/dashboard/NAME. What another gateway changes
/// is seen here as soon as the broker says it; what is written here counts once the broker has sent it back.
/// A broker that has forgotten all of them is given them again; where the last one was removed, kRemoved is
/// kept in its place, so that this is not taken for a broker that has forgotten. Pure: messages and time in,
/// messages out.
class Dashboards {
  public:
    static constexpr std::size_t kMax = 64;
    static constexpr std::string_view kRemoved = R"({"removed":true})";
    static constexpr Duration kWriteTime = std::chrono::seconds(5);

    struct Port {
        std::function<bool(mqtt::Message)> publish;  ///< false: refused
        std::function<void()> changed;               ///< another list, or another dashboard
        std::function<void(const std::string& sentence)> log;
    };
    /// Empty: it is kept. Else why not.
    using Done = std::function<void(const std::string& error)>;

    Dashboards(const std::string& topic_root, Port port)
        : prefix_(topic_root + "/export/dashboard/"), port_(std::move(port)) {}

    std::string subscription() const { return prefix_ + "+"; }
    /// The topic is subscribed to: what is retained follows, or came already.
    void subscribed() { connected_ = true; }
    /// All that the broker retains has come.
    void complete();
    void disconnected();
    /// True: the message was one of a dashboard.
    bool take(const mqtt::Message& message);
    void tick(Time now);

    /// Whether all that is kept is known; before that, one that is not there may be.
    bool known() const { return known_; }
    /// Null: there is none of this name.
    const Dashboard* find(std::string_view name) const;
    const std::map<std::string, Dashboard, std::less<>>& all() const { return dashboards_; }
    /// Goes up with every change.
    std::uint64_t version() const { return version_; }

    /// What a client may do with a link whose token has this hash.
    std::optional<Rights> link_of(std::string_view hash) const;
    /// Whether a link still gives these rights.
    bool holds(const Rights& rights) const;

    /// A write of this dashboard is under way.
    bool busy(const std::string& name) const { return writes_.contains(name); }
    bool has_room() const { return dashboards_.size() + writes_.size() < kMax; }
    /// Keeps it, or with nothing removes it; `done` is called once. Not while busy().
    void write(const std::string& name, const std::optional<Dashboard>& dashboard, Time now, Done done);

  private:
    struct Write {
        std::string payload;
        Time until;
        Done done;
    };
    void apply(const std::string& name, const std::string& payload);
    std::string removal_of(const std::string& name) const;
    mqtt::Message message_of(const std::string& name, std::string payload) const;

    std::string prefix_;
    Port port_;
    std::map<std::string, Dashboard, std::less<>> dashboards_;
    std::map<std::string, Write, std::less<>> writes_;
    std::set<std::string> removed_;  // those of which kRemoved is kept
    std::set<std::string> seen_;     // while what is retained is read
    bool reading_ = true;
    bool connected_ = false;
    bool known_ = false;
    bool told_too_many_ = false;
    std::uint64_t version_ = 0;
};

}  // namespace asip::gateway
