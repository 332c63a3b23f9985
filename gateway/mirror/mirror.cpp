// SPDX-License-Identifier: Apache-2.0
#include "gateway/mirror/mirror.hpp"

#include "asip/bus/pattern.hpp"
#include "asip/bus/registry/answer.hpp"
#include "asip/model/json.hpp"
#include "asip/property/value.hpp"

#include <nlohmann/json.hpp>

namespace asip::gateway {
namespace {

using bus::TopicKind;
using catalogue::Event;

constexpr Duration kSettleTime = std::chrono::seconds(5);
constexpr std::size_t kMaxRegistries = 64;
constexpr std::size_t kMaxStatsBytes = 64 * 1024;
constexpr std::size_t kSnapshotNames = 500;
constexpr std::size_t kSnapshotBytes = 16 * 1024;
constexpr std::size_t kMaxKnown = 500;
constexpr std::size_t kMaxEarly = 2000;
constexpr std::size_t kMaxLinksBytes = 256 * 1024;
constexpr std::size_t kMaxBoardStatsBytes = 8 * 1024;
constexpr Duration kStatsTime = std::chrono::seconds(45);  // three of the agents' intervals

catalogue::Instant both(const Instant& now) {
    return {now.time, now.wall};
}

bus::ChangeEvent::Kind kind_of(Event::Kind kind) {
    using Kind = bus::ChangeEvent::Kind;
    switch (kind) {
        case Event::Kind::kAdded:
            return Kind::kAdded;
        case Event::Kind::kState:
            return Kind::kState;
        case Event::Kind::kDescription:
            return Kind::kDescription;
        case Event::Kind::kConflict:
            return Kind::kConflict;
        case Event::Kind::kResolved:
            return Kind::kResolved;
        default:
            return Kind::kForgotten;
    }
}

catalogue::Catalogue::Options catalogue_options(const Mirror::Options& options, const Random& random) {
    catalogue::Catalogue::Options result;
    result.forget_after = options.forget_after;
    result.units_of = options.units_of;
    result.hash_seed = random();
    return result;
}

}  // namespace

Mirror::Mirror(Options options, Random random, Port port)
    : topics_(options.topic_root),
      options_(std::move(options)),
      random_(std::move(random)),
      port_(std::move(port)),
      log_(random_hex(random_, 8)),
      values_(log_.epoch(), options_.values),
      catalogue_(catalogue_options(options_, random_)) {
    catalogue_.suspend();
}

std::vector<std::pair<std::string, bool>> Mirror::subscriptions() const {
    return {{topics_.root() + "/servicebus/#", true},
            {topics_.service_out("+", "+"), true},
            {topics_.service_error("+", "+"), false},
            {topics_.values("+"), true},
            {topics_.links("+"), true},
            {topics_.registry_state("+"), true},
            {topics_.registry_stats("+"), true},
            {options_.own_topic, false}};
}

void Mirror::status(const Instant& now, std::string_view broker) {
    log_.add("status", {},
             R"({"at":")" + text::iso_time(now.wall) + R"(","broker":")" + std::string(broker) + "\"}");
}

void Mirror::subscribed(const Instant& now) {
    if (subscribed_) return;
    subscribed_ = true;
    since_ = now;
    catalogue_.resume(now.time);
    status(now, "connected");
    mark_ = random_hex(random_, 16);
    mark_sent_ = now.time;
    port_.publish(mqtt::Message{.topic = options_.own_topic, .payload = mark_});
    mqtt::Message probe;
    probe.topic = topics_.probe();
    port_.publish(std::move(probe));
}

void Mirror::disconnected(const Instant& now) {
    standing_.reading();
    if (!subscribed_) return;
    subscribed_ = false;
    links_.clear();
    mark_.clear();
    since_ = now;
    catalogue_.suspend();
    status(now, "lost");
}

void Mirror::message(const mqtt::Message& message, const Instant& now) {
    if (message.topic == options_.own_topic) {
        if (!mark_.empty() && message.payload == mark_) complete_now(now);
        return;
    }
    const auto topic = topics_.parse(message.topic);
    if (!topic) return;
    switch (topic->kind) {
        case TopicKind::kRegistryState:
        case TopicKind::kRegistryStats:
            return registry_message(*topic, message, now);
        case TopicKind::kStats:
            if (message.payload.size() <= kMaxBoardStatsBytes && catalogue_.knows(topic->board))
                board_stats_[std::string(topic->board)] = {message.payload, now.time};
            return;
        case TopicKind::kLog:
        case TopicKind::kCommands:
        case TopicKind::kDemand:
        case TopicKind::kLink:
            return;
        case TopicKind::kLinks: {
            const std::string board(topic->board);
            const bool room = links_.size() < catalogue_.size() + kMaxEarly || links_.contains(board);
            if (message.payload.empty() || message.payload.size() > kMaxLinksBytes)
                links_.erase(board);
            else if (room && (!subscribed_ || reading() || catalogue_.knows(board)))
                links_[board] = message.payload;
            return;
        }
        case TopicKind::kProperties:
        case TopicKind::kValues:
            return standing_message(*topic, message, now);
        case TopicKind::kServiceError:
        case TopicKind::kServiceOut: {
            announcement(message, *topic, now);
            const bool error = topic->kind == TopicKind::kServiceError;
            if (catalogue_.knows(topic->board))
                values_.value(topic->board, topic->service, message.payload, error, now);
            return;
        }
        default:
            announcement(message, *topic, now);
    }
}

// A retained message may come ahead of its board.
void Mirror::standing_message(const bus::TopicRef& topic, const mqtt::Message& message, const Instant& now) {
    const std::string board(topic.board);
    const auto item = known(board, now);
    if (!item && ((subscribed_ && mark_.empty()) || standing_.size() >= catalogue_.size() + kMaxEarly))
        return;
    const std::string_view session = item ? std::string_view(item->session) : std::string_view();
    const auto change =
        topic.kind == TopicKind::kProperties
            ? standing_.take_list(board, message.payload, session)
            : standing_.take_values(board, message.payload, session, now.time, message.retain);
    if (change || change.anew) standing_changed(board, change, now);
}

void Mirror::standing_changed(const std::string& board, const Standing::Change& change, const Instant& now) {
    if (change.anew) values_.begin_anew(board);
    standing_.tell(board, change);
    const auto item = change.list ? catalogue_.board(board, both(now)) : std::nullopt;
    if (item)
        log_.add("properties", board,
                 model::dump_json({{"at", text::iso_time(now.wall)}, {"board", bus::to_json(*item)}}));
}

std::optional<property::ShownValue> Mirror::shown(const std::string& board,
                                                  const property::Property& property, const Instant& now) {
    property::ShownValue shown;
    const auto* reported = is_reported(property) ? values_.find(board, property.read->service) : nullptr;
    const ChannelValue* newest = nullptr;
    for (std::size_t i = 0; reported != nullptr && i < reported->channels.size(); ++i) {
        const auto& channel = reported->channels[i];
        if (channel.error || channel.outdated || channel.cut > 0) continue;
        const auto is_there = [&] { return property.read->pointer.starts_with("/" + channel.event); };
        if ((!channel.event.empty() && !is_there()) || (newest != nullptr && newest->number > channel.number))
            continue;
        const auto published = model::parse_json(channel.json());
        auto value = published ? property::value_in(property, *published) : std::nullopt;
        if (!value) continue;
        newest = &channel;
        shown.value = std::move(*value);
        shown.how = property::How::kReported;
        shown.age = std::chrono::duration<double>(now.time - channel.seen.time).count();
    }
    if (newest != nullptr) return shown;
    const auto item = known(board, now);
    auto stands = item ? standing_.value(board, item->session, property.id, now.time) : std::nullopt;
    const bool light = property.kind == property::Kind::kLight;
    if (stands && !stands->value.is_null() && stands->value.is_object() != light) return std::nullopt;
    return stands;
}

void Mirror::announcement(const mqtt::Message& message, const bus::TopicRef& topic, const Instant& now) {
    const auto applied = catalogue_.apply(
        {topic.kind, topic.board, message.payload, message.retain, message.expiry_seconds}, now.time);
    handle(applied.events, now);
}

void Mirror::registry_message(const bus::TopicRef& topic, const mqtt::Message& message, const Instant& now) {
    const std::string id(topic.board);
    const bool known = registries_.count(id) > 0;
    if (!known && (message.payload.empty() || registries_.size() >= kMaxRegistries)) return;
    auto& info = registries_[id];
    info.seen = now.time;
    if (topic.kind == TopicKind::kRegistryState) {
        if (message.payload.empty())
            registries_.erase(id);
        else if (message.payload.size() <= 32)
            info.state = message.payload;
    } else if (message.payload.size() <= kMaxStatsBytes) {
        info.stats = message.payload;
    }
}

void Mirror::handle(const std::vector<Event>& events, const Instant& now) {
    for (const auto& event : events)
        if (event.is_change())
            change(event, now);
        else if (event.kind == Event::Kind::kListen)
            port_.subscribe(topics_.board_out(event.board), false);
        else if (event.kind == Event::Kind::kUnlisten)
            port_.unsubscribe(topics_.board_out(event.board));
}

void Mirror::change(const Event& event, const Instant& now) {
    known_.erase(event.board);
    nlohmann::json object{{"at", text::iso_time(now.wall)}, {"board", {{"board", event.board}}}};
    if (event.kind == Event::Kind::kForgotten) {
        values_.forget(event.board);
        standing_.forget(event.board);
        links_.erase(event.board);
    } else if (const auto item = catalogue_.board(event.board, both(now))) {
        object["board"] = bus::to_json(*item);
    }
    if (event.kind == Event::Kind::kState) object["was"] = model::to_text(event.was);
    if (event.reason != model::StateReason::kNone) object["reason"] = model::to_text(event.reason);
    log_.add(bus::to_string(kind_of(event.kind)), event.board, model::dump_json(object));
}

void Mirror::complete_now(const Instant& now) {
    mark_.clear();
    complete_ = true;
    catalogue_.settle();
    std::erase_if(links_, [this](const auto& each) { return !catalogue_.knows(each.first); });
    // What the broker does not retain any more was cleared while it was not heard.
    Standing::Change gone;
    gone.list = true;
    for (const auto& board : standing_.complete([this](const auto& name) { return catalogue_.knows(name); }))
        standing_changed(board, gone, now);
    values_.expire(now);
}

void Mirror::tick(const Instant& now) {
    if (subscribed_) handle(catalogue_.expire(now.time, catalogue::Catalogue::kJudgedAtOnce), now);
    if (!mark_.empty() && now.time - mark_sent_ >= kSettleTime) complete_now(now);
    values_.expire(now);
    std::erase_if(board_stats_, [&](const auto& each) { return now.time - each.second.seen > kStatsTime; });
}

std::optional<bus::BoardItem> Mirror::board(std::string_view name, const Instant& now) const {
    return catalogue_.board(name, both(now));
}

std::shared_ptr<const bus::BoardItem> Mirror::known(const std::string& name, const Instant& now) {
    if (const auto found = known_.find(name); found != known_.end()) return found->second;
    auto item = catalogue_.board(name, both(now));
    if (!item) return nullptr;
    if (known_.size() >= kMaxKnown) known_.clear();
    return known_[name] = std::make_shared<const bus::BoardItem>(std::move(*item));
}

Expected<bus::Answer> Mirror::find(const bus::Query& query, const Instant& now, const catalogue::View* view) {
    auto answer = catalogue_.find(query, both(now), view);
    if (answer) {
        answer->epoch = log_.epoch();
        answer->seq = log_.last();
        answer->settling = !complete_;
    }
    return answer;
}

Mirror::Lost Mirror::lost(const catalogue::View& view, const Instant& now) {
    Lost lost;
    std::vector<std::string> silent;
    catalogue_.for_each([&](std::string_view board, model::BoardState state, model::StateReason reason) {
        if (state != model::BoardState::kLost || (view.board && !view.board(board))) return;
        ++lost.by_reason[reason];
        if (reason == model::StateReason::kSilent) silent.emplace_back(board);
    });
    for (const auto& name : silent) {
        const auto board = known(name, now);
        if (!board || !board->chip.empty() || !board->services.empty()) continue;
        ++lost.without_asip;
        --lost.by_reason[model::StateReason::kSilent];
    }
    return lost;
}

std::vector<std::string> Mirror::board_names() const {
    std::vector<std::string> names;
    catalogue_.for_each(
        [&](std::string_view name, model::BoardState, model::StateReason) { names.emplace_back(name); });
    return names;
}

// A page of few boards, and of few names that are looked at: others are served between two of them.
ChangeFeed::ReadPage Mirror::read_page(ChangeFeed::Allowed allowed,
                                       std::function<void(bus::BoardItem&)> limit) {
    return [this, allowed = std::move(allowed), limit = std::move(limit)](
               const std::string& pattern, const std::string& after, const Instant& now) {
        ChangeFeed::Page page{{}, {}, false};
        const auto names = catalogue_.names(pattern, after, kSnapshotNames);
        std::size_t bytes = 0;
        for (const auto& name : names) {
            page.behind = name;
            if (!bus::matches_pattern(pattern, name) || (allowed && !allowed(name))) continue;
            auto item = catalogue_.board(name, both(now));
            if (!item) continue;
            if (limit) limit(*item);
            std::string text;
            bus::append_json(text, *item);
            bytes += text.size();
            page.boards.push_back(std::move(text));
            if (bytes >= kSnapshotBytes && &name != &names.back()) return page;
        }
        page.last = names.size() < kSnapshotNames;
        return page;
    };
}

}  // namespace asip::gateway
