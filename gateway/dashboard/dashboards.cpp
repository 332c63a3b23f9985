// SPDX-License-Identifier: Apache-2.0
#include "gateway/dashboard/dashboards.hpp"

#include <utility>

#include "asip/text/printable.hpp"

namespace asip::gateway {

// A broker may send what it retains ahead of its answer to the subscription.
void Dashboards::disconnected() {
    connected_ = false;
    reading_ = true;
    seen_.clear();
    removed_.clear();
}

// A broker that kept nothing has none of them. Where it has some, the others were removed while it was not
// heard.
void Dashboards::complete() {
    if (!connected_ || !std::exchange(reading_, false)) return;
    const bool forgotten = seen_.empty();
    known_ = true;
    for (auto each = dashboards_.begin(); each != dashboards_.end();) {
        if (seen_.contains(each->first)) {
            ++each;
        } else if (forgotten) {
            port_.publish(message_of(each->first, kept_text(each->second)));
            ++each;
        } else {
            each = dashboards_.erase(each);
        }
    }
    seen_.clear();
    ++version_;
    port_.changed();
}

mqtt::Message Dashboards::message_of(const std::string& name, std::string payload) const {
    return mqtt::Message{.topic = prefix_ + name, .payload = std::move(payload), .qos = 1, .retain = true};
}

bool Dashboards::take(const mqtt::Message& message) {
    if (!message.topic.starts_with(prefix_)) return false;
    const auto name = message.topic.substr(prefix_.size());
    if (!valid_dashboard_name(name)) return true;
    if (reading_ && !message.payload.empty()) seen_.insert(name);
    apply(name, message.payload);
    if (const auto write = writes_.find(name);
        write != writes_.end() && write->second.payload == message.payload) {
        const auto done = std::move(write->second.done);
        writes_.erase(write);
        done({});
    }
    return true;
}

void Dashboards::apply(const std::string& name, const std::string& payload) {
    removed_.erase(name);
    if (payload == kRemoved) removed_.insert(name);
    if (payload.empty() || payload == kRemoved) {
        if (dashboards_.erase(name) == 0) return;
    } else if (!dashboards_.contains(name) && dashboards_.size() >= kMax) {
        if (!std::exchange(told_too_many_, true))
            port_.log("there are more than " + std::to_string(kMax) + " dashboards; others are left out");
        return;
    } else if (auto dashboard = parse_kept_dashboard(payload)) {
        dashboards_[name] = std::move(*dashboard);
    } else {
        port_.log("dashboard " + name + " cannot be read: " + text::printable(dashboard.error()));
        if (dashboards_.erase(name) == 0) return;
    }
    ++version_;
    port_.changed();
}

// A gateway that does not hear the bus at this moment would bring the last one back, with its links.
std::string Dashboards::removal_of(const std::string& name) const {
    const bool last = dashboards_.size() == 1 && dashboards_.contains(name);
    return last ? std::string(kRemoved) : std::string();
}

void Dashboards::write(const std::string& name, const std::optional<Dashboard>& dashboard, Time now,
                       Done done) {
    auto payload = dashboard ? kept_text(*dashboard) : removal_of(name);
    if (payload.size() > Dashboard::kMaxKept) return done("it is too long");
    if (!connected_) return done("the broker is not connected");
    writes_[name] = {payload, now + kWriteTime, std::move(done)};
    if (port_.publish(message_of(name, std::move(payload)))) {
        // Where there is a dashboard, nothing else needs to be kept.
        for (const auto& each : dashboard ? removed_ : std::set<std::string>())
            if (each != name && !writes_.contains(each)) port_.publish(message_of(each, {}));
        return;
    }
    const auto refused = std::move(writes_[name].done);
    writes_.erase(name);
    refused("too much waits to be sent to the broker");
}

void Dashboards::tick(Time now) {
    for (auto each = writes_.begin(); each != writes_.end();) {
        if (each->second.until > now) {
            ++each;
            continue;
        }
        const auto done = std::move(each->second.done);
        const auto topic = prefix_ + each->first;
        each = writes_.erase(each);
        done("the broker did not keep it: may this gateway write to " + topic +
             "? asipctl secure init writes the rules anew");
        each = writes_.begin();  // the call may have begun another
    }
}

const Dashboard* Dashboards::find(std::string_view name) const {
    const auto found = dashboards_.find(name);
    return found == dashboards_.end() ? nullptr : &found->second;
}

std::optional<Rights> Dashboards::link_of(std::string_view hash) const {
    for (const auto& [name, dashboard] : dashboards_)
        for (const auto& link : dashboard.links)
            if (link.hash == hash) return rights_of(name, link);
    return std::nullopt;
}

bool Dashboards::holds(const Rights& rights) const {
    const auto* dashboard = find(rights.dashboard);
    const auto at = rights.name.find('@');
    const auto* link = dashboard == nullptr ? nullptr : dashboard->link(rights.name.substr(0, at));
    return link != nullptr && rights_of(rights.dashboard, *link) == rights;
}

}  // namespace asip::gateway
