// SPDX-License-Identifier: Apache-2.0
#include "cli/ask/retained.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "asip/catalogue/bus_view.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/description.hpp"
#include "cli/ask/board_source.hpp"

namespace asip::cli {
namespace {

/// What the retained topics show of boards and registries.
struct Claims {
    catalogue::BusView boards;
    std::map<std::string, std::string> registries;

    Claims(const bus::Topics& topics, const std::vector<Retained>& all) : boards(topics) {
        for (const auto& [topic, payload, expiry_seconds] : all) {
            const auto ref = topics.parse(topic);
            if (!ref) continue;
            if (ref->kind == bus::TopicKind::kRegistryState) registries[std::string(ref->board)] = payload;
            // Names are said, not stored: they make no board.
            if (ref->kind != bus::TopicKind::kState && ref->kind != bus::TopicKind::kDescription) continue;
            mqtt::Message message{
                .topic = topic, .payload = payload, .retain = true, .expiry_seconds = expiry_seconds};
            boards.apply(message, kThen);
        }
    }

    /// Empty for a board that seems alive.
    std::string why_gone(const std::string& board) {
        const auto known = boards.board(board, {kThen, {}});
        if (known && !model::is_gone(known->state)) return {};
        if (known && known->reason == to_text(model::StateReason::kExpired)) return "its lease ran out";
        return "the board is " + (known ? known->state : "not announced");
    }

  private:
    static constexpr Time kThen = Time{} + std::chrono::hours(1);  // all of it is of one moment
};

bool is_command(bus::TopicKind kind) {
    return kind == bus::TopicKind::kBoardIn || kind == bus::TopicKind::kStop ||
           kind == bus::TopicKind::kLink || kind == bus::TopicKind::kServiceIn ||
           kind == bus::TopicKind::kDemand || kind == bus::TopicKind::kProbe ||
           kind == bus::TopicKind::kAnyRegistryQuery || kind == bus::TopicKind::kRegistryQuery;
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

/// Topics of no board or registry: requests to forget, commands to what a gateway exports, and
/// what reads like a command.
bool looks_like_command(const bus::Topics& topics, std::string_view topic) {
    const bool of_registry = topic.starts_with(topics.root() + "/registry/");
    const bool of_export = topic.starts_with(topics.root() + "/export/");
    return topic.ends_with("/in") || topic.ends_with("/$stop") ||
           (of_registry && (topic.ends_with("/forget") || topic.ends_with("/query"))) ||
           (of_export && topic.ends_with("/set"));
}

}  // namespace

Outcome<std::vector<Retained>> read_retained(const Environment& environment, BusSession& session,
                                             const std::vector<std::string>& filters) {
    std::map<std::string, Retained> found;
    std::vector<BusSession::Subscription> subscriptions;
    for (const auto& filter : filters) {
        subscriptions.push_back(session.subscribe(filter, [&found](const mqtt::Message& message) {
            if (message.retain && !message.payload.empty())
                found[message.topic] = {message.topic, message.payload, message.expiry_seconds};
        }));
    }
    session.wait_retained([] { return false; }, environment.timeout);
    if (const auto heard = session.heard_all(); !heard) return tl::unexpected(heard.error());
    std::vector<Retained> result;
    for (auto& [topic, message] : found)
        result.push_back(std::move(message));
    return result;
}

namespace {

/// Below what may wait in our own queue.
constexpr std::size_t kPutAtOnce = 1000;
constexpr std::size_t kMaxTopicsOfPass = 100'000;
constexpr int kMaxVainPasses = 3;
constexpr Duration kSilence = std::chrono::seconds(15);

}  // namespace

Outcome<void> put_retained(const Environment& environment, BusSession& session,
                           const std::vector<Retained>& messages) {
    for (std::size_t begin = 0; begin < messages.size(); begin += kPutAtOnce) {
        const auto end = std::min(begin + kPutAtOnce, messages.size());
        for (auto i = begin; i < end; ++i)
            session.publish(messages[i].topic, messages[i].payload, 1, true);
        const auto mark = session.mark_retained();
        const auto patience = environment.timeout + std::chrono::seconds(1);
        if (!session.run_until([&mark] { return mark.passed(); }, Clock::now() + patience))
            return tl::unexpected(
                session.unanswered("the broker did not confirm in time; run it again to see what is left"));
    }
    return {};
}

Outcome<void> clear_retained(const Environment& environment, BusSession& session,
                             const std::vector<std::string>& topics) {
    std::vector<Retained> nothing;
    for (const auto& topic : topics)
        nothing.push_back({topic, ""});
    return put_retained(environment, session, nothing);
}

Outcome<std::size_t> clear_all_retained(const Environment& environment, BusSession& session,
                                        const std::vector<std::string>& filters) {
    std::size_t cleared = 0;
    std::set<std::string> before;
    for (int vain = 0; vain < kMaxVainPasses;) {
        std::set<std::string> found;
        auto heard = Clock::now();
        std::vector<BusSession::Subscription> subscriptions;
        for (const auto& filter : filters)
            subscriptions.push_back(session.subscribe(filter, [&](const mqtt::Message& message) {
                heard = Clock::now();
                if (message.retain && !message.payload.empty() && found.size() < kMaxTopicsOfPass)
                    found.insert(message.topic);
            }));
        const auto mark = session.mark_retained();
        session.run_until([&] { return mark.passed() || Clock::now() > heard + kSilence; }, Time::max());
        subscriptions.clear();
        if (session.stopped()) return interrupted();
        if (!mark.passed()) return tl::unexpected(session.unanswered("the broker does not answer"));
        if (found.empty()) return cleared;
        if (const auto done = clear_retained(environment, session, {found.begin(), found.end()}); !done)
            return tl::unexpected(done.error());
        vain = found == before ? vain + 1 : 0;
        if (vain == 0) cleared += found.size();
        before = std::move(found);
    }
    return failure(program::kExitFailure, "the broker keeps " + *before.begin() + " whatever is asked");
}

std::vector<Lingering> find_lingering(const bus::Topics& topics, const std::vector<Retained>& all) {
    Claims claims(topics, all);
    std::vector<Lingering> result;
    for (const auto& message : all) {
        const auto ref = topics.parse(message.topic);
        if (!ref) {
            // Other topics below our root belong to other programs.
            if (looks_like_command(topics, message.topic)) {
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
        } else if (!claims.boards.knows(name)) {
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
    const auto names = Claims(topics, all).boards.names();
    return {names.begin(), names.end()};
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
    return Claims(topics, all).why_gone(board).empty();
}

}  // namespace asip::cli
