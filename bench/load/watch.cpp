// SPDX-License-Identifier: Apache-2.0
#include "bench/load/watch.hpp"

#include <utility>

namespace asip::load {
namespace {

constexpr std::size_t kShownBoards = 3;
constexpr auto kBetweenComparisons = std::chrono::milliseconds(100);

mqtt::Options watch_options(mqtt::Options options) {
    // A snapshot is large.
    options.max_packet_bytes = 0;
    return options;
}

}  // namespace

std::optional<Time> happened(const Fleet& fleet, const bus::ChangeEvent& event) {
    using Kind = bus::ChangeEvent::Kind;
    if (event.kind != Kind::kAdded && event.kind != Kind::kState) return std::nullopt;
    const auto board = fleet.number(event.board.board);
    if (!board || event.board.state != fleet.expected(*board)) return std::nullopt;
    const bool told =
        event.board.state == "online" || (event.board.state == "lost" && event.reason == "agent-gone");
    return told ? std::optional(fleet.since(*board)) : std::nullopt;
}

Watch::Watch(boost::asio::io_context& io, mqtt::Options options, const std::string& topic_root,
             const std::string& prefix, const Fleet& fleet)
    : fleet_(fleet),
      topics_(topic_root),
      prefix_(prefix),
      bus_(io, watch_options(std::move(options)), topics_, "-watch",
           [this](const mqtt::Message& message) { received(message); }),
      limit_(io),
      again_(io) {
    bus_.client.subscribe(topics_.registry_events("+"));
    bus_.client.subscribe(topics_.registry_state("+"), {.qos = 1});
}

void Watch::received(const mqtt::Message& message) {
    const auto topic = topics_.parse(message.topic);
    if (!topic) return;
    if (topic->kind == bus::TopicKind::kRegistryState) {
        living_[std::string(topic->board)] = message.payload == "online";
        return;
    }
    if (topic->kind != bus::TopicKind::kRegistryEvents) return;
    if (const auto change = bus::parse_change_event(message.payload)) event(*change);
}

void Watch::event(const bus::ChangeEvent& event) {
    using Kind = bus::ChangeEvent::Kind;
    Watched& watched = registries_[event.registry];
    watched.numbers.take(event.epoch, event.seq, event.kind == Kind::kReset);
    if (event.kind != Kind::kAdded && event.kind != Kind::kState) return;
    if (!fleet_.number(event.board.board)) return;
    ++watched.events;
    if (const auto since = happened(fleet_, event))
        (event.board.state == "online" ? watched.online : watched.lost).add(Clock::now() - *since);
}

void Watch::compare(Duration limit, std::function<void()> done) {
    done_ = std::move(done);
    compared_since_ = Clock::now();
    limit_.expires_after(limit);
    limit_.async_wait([this](const boost::system::error_code& error) {
        if (!error) finish();
    });
    for (const auto& [registry, lives] : living_) {
        if (!lives) continue;  // it said goodbye, or its will did
        comparisons_.emplace(registry, Comparison{});
        registries_[registry].wrong = fleet_.size();
    }
    if (comparisons_.empty()) return finish();
    for (auto& [registry, comparison] : comparisons_)
        ask(registry, {});
}

void Watch::ask(const std::string& registry, const std::string& cursor) {
    bus::Query query;
    query.board = prefix_ + "*";
    query.brief = true;
    query.limit = bus::Query::kMaxPage;
    query.cursor = cursor;
    mqtt::Message message;
    message.topic = topics_.registry_query(registry);
    message.payload = bus::encode(bus::RegistryRequest{query, {}, {}});
    message.qos = 1;
    const auto answered = [this, registry](const mqtt::Message& answer) {
        if (const auto read = bus::parse_answer(answer.payload)) page(registry, *read);
    };
    comparisons_[registry].request = bus_.caller.ask(std::move(message), answered, Clock::now());
}

void Watch::page(const std::string& registry, const bus::Answer& answer) {
    if (!done_) return;
    Comparison& comparison = comparisons_[registry];
    if (!answer.refused.empty() || answer.settling) return compare_again(registry);
    const bus::BriefRows none;
    const auto& rows = answer.brief ? *answer.brief : none;
    for (const auto& row : rows.rows()) {
        const auto board = fleet_.number(row.board);
        if (!board) continue;
        ++comparison.listed;
        const auto expected = fleet_.expected(*board);
        if (expected == row.state) {
            ++comparison.right;
        } else if (!expected.empty()) {
            ++comparison.wrong;
            if (comparison.examples.size() < kShownBoards)
                comparison.examples.push_back(std::string(row.board) + " is listed as " +
                                              std::string(row.state) + " and is " + std::string(expected));
        }
    }
    if (!answer.cursor.empty()) return ask(registry, answer.cursor);
    compared(registry);
}

void Watch::compared(const std::string& registry) {
    Comparison& comparison = comparisons_[registry];
    std::size_t there = 0;
    for (std::size_t board = 0; board < fleet_.size(); ++board)
        there += fleet_.expected(board).empty() ? 0 : 1;
    Watched& watched = registries_[registry];
    const std::size_t known = comparison.right + comparison.wrong;
    const std::size_t missing = there > known ? there - known : 0;
    watched.listed = comparison.listed;
    watched.wrong = comparison.wrong + missing;
    watched.examples = std::move(comparison.examples);
    if (missing > 0) watched.examples.push_back(std::to_string(missing) + " boards are not listed");
    if (watched.wrong > 0) return compare_again(registry);
    watched.agreed = Clock::now() - compared_since_;
    for (const auto& [id, each] : comparisons_)
        if (!registries_[id].agreed) return;
    finish();
}

void Watch::compare_again(const std::string& registry) {
    comparisons_[registry] = {};
    again_.expires_after(kBetweenComparisons);
    again_.async_wait([this](const boost::system::error_code& error) {
        if (error || !done_) return;
        for (const auto& [id, each] : comparisons_)
            if (!registries_[id].agreed && each.request.id().empty()) ask(id, {});
    });
}

void Watch::finish() {
    limit_.cancel();
    again_.cancel();
    if (const auto done = std::exchange(done_, {})) done();
}

}  // namespace asip::load
