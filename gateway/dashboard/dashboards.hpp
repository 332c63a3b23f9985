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

/// The dashboards that are retained at ROOT/export/dashboard/NAME. What any gateway writes counts once the
/// broker has sent it. A broker that forgot all gets them again; kRemoved, in place of the last one, tells
/// that apart from a removal. Pure.
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
    /// What is retained follows, or came already.
    void subscribed() { connected_ = true; }
    void complete();
    void disconnected();
    /// True: the message was one of a dashboard.
    bool take(const mqtt::Message& message);
    void tick(Time now);

    /// All that is kept is known.
    bool known() const { return known_; }
    const Dashboard* find(std::string_view name) const;
    const std::map<std::string, Dashboard, std::less<>>& all() const { return dashboards_; }
    std::uint64_t version() const { return version_; }

    /// By the hash of the link's token.
    std::optional<Rights> link_of(std::string_view hash) const;
    /// A link still gives these rights.
    bool holds(const Rights& rights) const;

    /// A write is under way.
    bool busy(const std::string& name) const { return writes_.contains(name); }
    bool has_room() const { return dashboards_.size() + writes_.size() < kMax; }
    /// Keeps it, or with nothing removes it; calls `done` once. Not while busy().
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
