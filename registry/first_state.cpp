// SPDX-License-Identifier: Apache-2.0
#include "registry/first_state.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "asip/bus/json/json_scanner.hpp"
#include "asip/bus/registry/query.hpp"
#include "asip/model/json.hpp"

namespace asip::registry {
namespace {

constexpr std::size_t kMaxOthers = 1000;  // statistics of registries that are gone stay

/// What of a board's item matters here.
struct Item {
    std::string_view board;
    std::string_view state;
    std::string_view reported;
    std::string_view reason;
    std::string_view description;
    std::string_view age;
    std::string_view lease;
    std::string_view state_age;
};

/// What is missing, or of another form than registries write, stays empty.
bool read_item(std::string_view text, Item& item) {
    bus::JsonScanner scanner(text);
    if (!scanner.enter_object()) return false;
    std::string_view key;
    std::string_view value;
    while (scanner.next_member(key)) {
        if (!scanner.plain_string(value) && !scanner.value(value)) return false;
        if (key == "board") item.board = value;
        if (key == "state") item.state = value;
        if (key == "reported") item.reported = value;
        if (key == "reason") item.reason = value;
        if (key == "description") item.description = value;
        if (key == "age") item.age = value;
        if (key == "lease") item.lease = value;
        if (key == "state_age") item.state_age = value;
    }
    return scanner.left();
}

double number(std::string_view text, double otherwise) {
    double value = 0;
    const auto end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    return read.ec == std::errc{} && read.ptr == end && std::isfinite(value) ? value : otherwise;
}

/// Seconds of the lease that are left. Of a board that the other registry has not heard itself, all.
std::uint32_t left_of(const Item& item) {
    const double lease = std::clamp(number(item.lease, 0), 0.0, 1e9);
    const double age = std::max(0.0, number(item.age, 0));
    return static_cast<std::uint32_t>(std::max(0.0, lease - age));
}

/// How old `$state` is, as its expiry would say.
std::optional<std::uint32_t> state_expiry(const Item& item) {
    const double age = number(item.state_age, -1);
    if (age < 0 || age > model::kMaxStateAgeSeconds) return std::nullopt;
    return model::kStateExpirySeconds - static_cast<std::uint32_t>(age);
}

bool is_there(std::string_view state) {
    const auto known = model::board_state_from_text(state);
    return !known || model::is_there(*known);
}

}  // namespace

FirstState::FirstState(const bus::Topics& topics, std::string id, std::string reply_topic,
                       std::size_t many_boards, Dependencies dependencies)
    : topics_(topics),
      id_(std::move(id)),
      reply_topic_(std::move(reply_topic)),
      many_boards_(many_boards),
      dependencies_(std::move(dependencies)) {}

void FirstState::begin(std::string mark, bool retained_comes, Time now) {
    run_ = std::move(mark);
    others_.clear();
    asked_ = 0;
    pages_ = 0;
    from_.clear();
    if (retained_comes) return wait_behind_retained(now);
    until_ = now + kAnswerTime;
    send_mark(Phase::kWho);
}

void FirstState::send_mark(Phase phase) {
    phase_ = phase;
    mark_ = run_ + (phase == Phase::kWho ? "-who" : "-retained");
    mqtt::Message message;
    message.topic = topics_.registry_query(id_);
    message.payload = mark_;
    dependencies_.publish(std::move(message));
}

bool FirstState::mark(std::string_view payload, Time now) {
    if (payload.empty() || payload != mark_) return false;
    if (phase_ == Phase::kRetained) whole();
    if (phase_ == Phase::kWho) next_registry(now);
    return true;
}

FirstState::Other* FirstState::other(std::string_view id) {
    if (phase_ != Phase::kWho || id == id_) return nullptr;
    const auto found = others_.find(id);
    if (found != others_.end()) return &found->second;
    return others_.size() < kMaxOthers ? &others_.try_emplace(std::string(id)).first->second : nullptr;
}

void FirstState::statistics(std::string_view id, std::string_view payload) {
    Other* const registry = other(id);
    if (registry == nullptr) return;
    const auto document = model::parse_json(payload, {.max_bytes = 1u << 20, .max_depth = 16});
    if (!document || !document->is_object() || !document->contains("boards")) return;
    registry->boards = 0;
    for (const auto& of_state : (*document)["boards"]) {
        if (of_state.is_number_unsigned()) registry->boards += of_state.get<std::size_t>();
    }
}

void FirstState::state(std::string_view id, std::string_view word) {
    if (Other* const registry = other(id)) registry->online = word == "online";
}

void FirstState::next_registry(Time now) {
    const auto worth = [](const auto& entry) { return entry.second.online ? entry.second.boards : 0; };
    const auto most = std::max_element(others_.begin(), others_.end(), [&](const auto& one, const auto& two) {
        return worth(one) < worth(two);
    });
    if (most == others_.end() || worth(*most) < many_boards_ || asked_ == kMostAsked) return retained(now);
    ++asked_;
    from_ = most->first;
    others_.erase(most);
    epoch_.clear();
    cursor_.clear();
    last_.clear();
    phase_ = Phase::kPages;
    ask_page(now);
}

void FirstState::ask_page(Time now) {
    until_ = now + kAnswerTime;
    question_ = run_ + '-' + std::to_string(++pages_);
    bus::Query query;
    query.limit = kPage;
    query.full = true;
    query.cursor = cursor_;
    mqtt::Message message;
    message.topic = topics_.registry_query(from_);
    message.payload = bus::encode(bus::RegistryRequest{query, question_, reply_topic_});
    dependencies_.publish(std::move(message));
}

void FirstState::answer(std::string_view payload, Time now) {
    if (phase_ != Phase::kPages) return;
    const auto page = bus::parse_answer_lines(payload);
    if (!page || page->answer.id != question_) return;
    if (!goes_on(*page)) return next_registry(now);
    cursor_ = page->answer.cursor;
    if (!cursor_.empty()) ask_page(now);  // written while this one is read
    if (!take(page->lines)) return next_registry(now);
    if (cursor_.empty()) whole();
}

/// Whether the page is of the same registry, in the same run, as those before it.
bool FirstState::goes_on(const bus::AnswerLines& page) {
    const auto& answer = page.answer;
    if (!answer.refused.empty() || answer.settling || answer.registry != from_) return false;
    if (page.lines.empty() && !answer.cursor.empty()) return false;
    if (epoch_.empty()) epoch_ = answer.epoch;
    return answer.epoch == epoch_;
}

// Names ascend, so that pages come to an end, whatever registry writes them.
bool FirstState::take(std::string_view lines) {
    while (!lines.empty()) {
        const auto end = lines.find('\n');
        if (!apply(lines.substr(0, end))) return false;
        lines.remove_prefix(std::min(lines.size(), end + 1));
    }
    return true;
}

// Boards that only publish their names are not retained either: they speak again. Of one that is gone for
// longer than its description was retained the state is.
bool FirstState::apply(std::string_view text) {
    Item item;
    if (!read_item(text, item) || item.board <= last_) return false;
    last_ = item.board;
    // That the lease is over is the other registry's judgement: nothing was said of the board but its
    // description.
    const bool judged = item.reported.empty() && item.reason == model::to_text(model::StateReason::kExpired);
    const auto said = judged                  ? model::to_text(model::BoardState::kOnline)
                      : item.reported.empty() ? item.state
                                              : item.reported;
    if (item.description.empty() && is_there(said)) return true;
    Announcement announcement{bus::TopicKind::kState, item.board, said, true, state_expiry(item), true};
    dependencies_.apply(announcement);
    if (item.description.empty()) return true;
    announcement.kind = bus::TopicKind::kDescription;
    announcement.payload = item.description;
    announcement.expiry_seconds = left_of(item);
    dependencies_.apply(announcement);
    return true;
}

void FirstState::retained(Time now) {
    from_.clear();
    dependencies_.read_retained();
    wait_behind_retained(now);
}

// The mark is sent first: the announcements that answer the probe come behind it.
void FirstState::wait_behind_retained(Time now) {
    until_ = now + kRetainedTime;
    send_mark(Phase::kRetained);
    dependencies_.probe();
}

void FirstState::whole() {
    phase_ = Phase::kWhole;
    dependencies_.complete();
}

void FirstState::tick(Time now) {
    if (!active() || now < until_) return;
    phase_ == Phase::kRetained ? whole() : next_registry(now);
}

}  // namespace asip::registry
