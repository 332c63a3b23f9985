// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/retained.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "asip/model/board_state.hpp"
#include "asip/model/description.hpp"
#include "cli/ask/board_source.hpp"

namespace asip::cli {
namespace {

/// What the retained topics hold of each board and registry.
struct Claims {
    std::map<std::string, std::string> states;
    std::set<std::string> described;
    std::map<std::string, std::string> registries;

    Claims(const bus::Topics& topics, const std::vector<Retained>& all) {
        for (const auto& message : all) {
            const auto ref = topics.parse(message.topic);
            if (!ref) continue;
            const std::string name(ref->board);
            if (ref->kind == bus::TopicKind::kState) states[name] = message.payload;
            if (ref->kind == bus::TopicKind::kDescription) described.insert(name);
            if (ref->kind == bus::TopicKind::kRegistryState) registries[name] = message.payload;
        }
    }

    bool announced(const std::string& board) const {
        return states.count(board) != 0 || described.count(board) != 0;
    }

    /// Empty for a board that seems alive.
    std::string why_gone(const std::string& board) const {
        const auto state = states.find(board);
        if (state != states.end() && state->second == "offline") return "the board is offline";
        if (state != states.end() && state->second == "lost") return "the board is lost";
        if (described.count(board) == 0) return "its lease ran out";
        return {};
    }
};

bool is_command(bus::TopicKind kind) {
    return kind == bus::TopicKind::kBoardIn || kind == bus::TopicKind::kStop ||
           kind == bus::TopicKind::kServiceIn || kind == bus::TopicKind::kDemand ||
           kind == bus::TopicKind::kProbe || kind == bus::TopicKind::kAnyRegistryQuery ||
           kind == bus::TopicKind::kRegistryQuery;
}

bool is_of_registry(bus::TopicKind kind) {
    return kind == bus::TopicKind::kRegistryState || kind == bus::TopicKind::kRegistryStats ||
           kind == bus::TopicKind::kRegistryEvents;
}

/// Empty for what can be read.
std::string why_unreadable(const bus::TopicRef& ref, const Retained& message) {
    if (ref.kind == bus::TopicKind::kState && !model::board_state_from_text(message.payload))
        return "unknown state: " + message.payload;
    if (ref.kind != bus::TopicKind::kDescription) return {};
    const auto description = model::parse_description(message.payload);
    if (!description) return description.error();
    return description->board == ref.board ? std::string() : "describes another board: " + description->board;
}

bool looks_like_command(std::string_view topic) {
    return topic.ends_with("/in") || topic.ends_with("/$stop");
}

}  // namespace

Outcome<std::vector<Retained>> read_retained(const Environment& environment, BusSession& session,
                                             const std::vector<std::string>& filters) {
    std::map<std::string, std::string> found;
    std::vector<BusSession::Subscription> subscriptions;
    for (const auto& filter : filters) {
        subscriptions.push_back(session.subscribe(filter, [&found](const mqtt::Message& message) {
            if (message.retain && !message.payload.empty()) found[message.topic] = message.payload;
        }));
    }
    session.wait_retained([] { return false; }, environment.timeout);
    if (const auto heard = session.heard_all(); !heard) return tl::unexpected(heard.error());
    std::vector<Retained> result;
    for (auto& [topic, payload] : found)
        result.push_back({topic, std::move(payload)});
    return result;
}

Outcome<void> clear_retained(const Environment& environment, BusSession& session,
                             const std::vector<std::string>& topics) {
    for (const auto& topic : topics)
        session.publish(topic, "", 1, true);
    const auto mark = session.mark_retained();
    const auto patience = environment.timeout + std::chrono::milliseconds(topics.size());
    if (session.run_until([&mark] { return mark.passed(); }, Clock::now() + patience)) return {};
    return tl::unexpected(
        session.unanswered("the broker did not confirm in time; run it again to see what is left"));
}

std::vector<Lingering> find_lingering(const bus::Topics& topics, const std::vector<Retained>& all) {
    const Claims claims(topics, all);
    std::vector<Lingering> result;
    for (const auto& message : all) {
        const auto ref = topics.parse(message.topic);
        if (!ref) {
            // Other topics below our root belong to other programs.
            if (looks_like_command(message.topic)) {
                result.push_back({Lingering::Kind::kCommand, message.topic, {}, "a retained command"});
            } else if (message.topic.starts_with(topics.board_names() + "/")) {
                result.push_back({Lingering::Kind::kInvalidName,
                                  message.topic,
                                  {},
                                  "announced under a name that is not valid"});
            }
            continue;
        }
        std::string name(ref->board);
        if (is_command(ref->kind)) {
            result.push_back({Lingering::Kind::kCommand, message.topic, name, "a retained command"});
        } else if (is_of_registry(ref->kind)) {
            const auto state = claims.registries.find(name);
            const bool alive = state != claims.registries.end() && state->second == "online";
            if (!alive)
                result.push_back(
                    {Lingering::Kind::kGoneRegistry, message.topic, {}, "registry " + name + " is gone"});
        } else if (auto fault = why_unreadable(*ref, message); !fault.empty()) {
            result.push_back({Lingering::Kind::kUnreadable, message.topic, name, std::move(fault)});
        } else if (name.empty()) {
            result.push_back(
                {Lingering::Kind::kOrphan, message.topic, {}, "an announcement is not to be retained"});
        } else if (!claims.announced(name)) {
            result.push_back({Lingering::Kind::kOrphan, message.topic, name, "this board is not announced"});
        } else if (auto why = claims.why_gone(name); !why.empty()) {
            result.push_back({Lingering::Kind::kGoneBoard, message.topic, name, std::move(why)});
        }
    }
    std::sort(result.begin(), result.end(),
              [](const Lingering& a, const Lingering& b) { return a.topic < b.topic; });
    return result;
}

std::set<std::string> announced_boards(const bus::Topics& topics, const std::vector<Retained>& all) {
    const Claims claims(topics, all);
    auto boards = claims.described;
    for (const auto& [board, state] : claims.states)
        boards.insert(board);
    return boards;
}

std::vector<std::string> topics_of_board(const bus::Topics& topics, const std::vector<Retained>& all,
                                         const std::string& board) {
    std::vector<std::string> result;
    for (const auto& message : all) {
        const bool announcement = message.topic == topics.service_names(board) ||
                                  message.topic.starts_with(topics.service_names(board) + "/");
        if (announcement || message.topic.starts_with(topics.root() + "/" + board + "/"))
            result.push_back(message.topic);
    }
    return result;
}

bool seems_alive(const bus::Topics& topics, const std::vector<Retained>& all, const std::string& board) {
    const Claims claims(topics, all);
    return claims.announced(board) && claims.why_gone(board).empty();
}

}  // namespace asip::cli
