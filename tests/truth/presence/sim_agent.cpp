// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/presence/sim_agent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace truth::presence {
namespace {

using asip::member::Announcements;
using asip::model::to_text;

constexpr std::uint64_t kStartOfTime = 1'790'000'000;  // of the day, when the simulation begins

// Messages of bridged brokers come in their order behind that.
constexpr Duration kReordered = std::chrono::milliseconds(800);

// A stored description counts before a word of otherwise that is older by more. Ages of both are whole
// seconds, and both take a while.
constexpr Duration kApart = std::chrono::seconds(2);
constexpr Duration kUnsure = std::chrono::milliseconds(1400);

std::string word_of(const Really& what) {
    return fmt::format("{} {}", to_text(what.state), to_text(what.reason));
}

Really until(Time lease_end, const Really& what, Time now) {
    if (!asip::model::is_there(what.state) || now < lease_end) return what;
    return {true, BoardState::kLost, StateReason::kExpired, lease_end, lease_end};
}

/// As agents of older versions announce.
void leave_out_state(std::string& description) {
    const auto begin = description.find(R"(,"state":{)");
    if (begin == std::string::npos) return;
    description.erase(begin, description.find('}', begin) + 1 - begin);
}

}  // namespace

bool BoardTruth::is_heard() const {
    return std::any_of(agents.begin(), agents.end(), [](const SimAgent* one) { return one->is_heard(); });
}

bool BoardTruth::holder_is_heard() const {
    return std::any_of(agents.begin(), agents.end(),
                       [&](const SimAgent* one) { return one->is_heard() && one->session() == session; });
}

bool BoardTruth::is_disputed() const {
    return std::count_if(agents.begin(), agents.end(), [](const SimAgent* one) { return one->claims(); }) > 1;
}

Before BoardTruth::before(const SimAgent& agent, Time now) const {
    Before before = Before::kEnded;
    for (const auto* one : agents) {
        if (one != &agent && one->runs() && !one->is_cut_off()) return Before::kLives;
        if (one->waits_for_will()) {
            before = now < lease_end ? Before::kLeaseRuns : Before::kLeaseOver;
        } else if (one != &agent && one->is_cut_off() && before == Before::kEnded) {
            before = Before::kWillCame;
        }
    }
    return before;
}

void BoardTruth::say(const Really& what) {
    const bool again = said.announced && word_of(said) == word_of(what) && said.since == what.since;
    const Time said_at = again ? said.said_at : what.said_at;
    said = what;
    said.said_at = said_at;
    taken_back = true;
    words.push_back({word_of(what), std::nullopt});
}

// A word that no agent took back before it ended, too.
Really BoardTruth::last_word() const {
    return !unordered_word || taken_back || holder_is_heard() ? said : *unordered_word;
}

Really BoardTruth::really(Time now) const {
    const Really last = last_word();
    return last.announced && !holder_is_heard() ? until(lease_end, last, now) : last;
}

Really BoardTruth::Stored::really(Time now) const {
    return until(lease_end, what, now);
}

std::vector<Really> BoardTruth::all_kept(Time now) const {
    const bool otherwise =
        !asip::model::is_there(kept_word.state) && kept_word.announced && kept_word.state != kept.what.state;
    std::vector<Really> all;
    if (otherwise && kept.at <= kept_word.since + kApart + kUnsure) all.push_back(kept_word);
    if (!otherwise || kept.at >= kept_word.since + kApart - kUnsure) all.push_back(kept.really(now));
    return all;
}

// Also of a name that was claimed and not announced yet. The agent of the session that counts takes it back;
// of a board that has the state already it changes nothing.
void BoardTruth::word(BoardState state, SimBroker::Client of, Time now) {
    const Really before = last_word();
    const Really what{true, state, asip::model::reason_of_word(state), now, now};
    say(what);
    in_vain.reset();
    kept_word = what;
    if (at_end && at_end->what.state != state) at_end->what = what;
    last_will = now;
    wills.push_back(now);
    const bool again = before.announced && before.state == state;
    const bool lives = holder_is_heard();
    if (again || lives) said = before;
    if (!again) last_new_word = now;
    if (again || (!lives && (of == described_by || now > described_at + kReordered))) return;
    unordered_word = what;
    taken_back = !lives;
}

bool BoardTruth::counts(const std::string& by, Time now) const {
    return by >= session || now >= lease_end;
}

void BoardTruth::describe(const Really& what, const std::string& by, SimBroker::Client over,
                          int lease_seconds, bool stored, Time now) {
    const bool is_there = asip::model::is_there(what.state);
    const Really gone{true, what.state, asip::model::reason_of_word(what.state), now, now};
    const bool just_gone_otherwise = !asip::model::is_there(said.state) && what.state != said.state &&
                                     now < std::max(described_at, last_will) + kReordered;
    if (at_end && now > at_end->lease_end + kUnsure) at_end.reset();
    // The word beside that description is of no session: it is taken for that of the other one. A later word
    // that the board is gone comes behind it.
    const bool took_word =
        asip::model::is_there(said.state) && unordered_word && unordered_word->since >= described_at;
    const Really last = took_word ? *unordered_word : said;
    if (by < session && now < lease_end + kUnsure) {
        at_end = {is_there ? last : gone, now, lease_end};
        if (!is_there) words.push_back({word_of(gone), std::nullopt});  // of no session
    }
    if (is_there) there_at = now;
    if (!stored && session != by) stored_until = std::min(stored_until, now);
    session = by;
    lease_end = now + std::chrono::seconds(lease_seconds);
    described_by = over;
    described_at = now;
    if (stored) stored_until = lease_end, in_vain.reset(), kept = {what, now, lease_end};
    if (unordered_word && now > unordered_word->since + kReordered) unordered_word.reset();
    if (just_gone_otherwise)  // behind the description, that word counts as a will
        unordered_word = Really{true, said.state, asip::model::reason_of_word(said.state), now, now};
    say(what);
}

void BoardTruth::describe_in_vain(const Really& what, int lease_seconds, bool stored, Time now) {
    if (stored) stored_until = std::min(stored_until, now);
    if (stored) vain_at = now;
    last_in_vain = {what, now, now + std::chrono::seconds(lease_seconds)};
    if (stored) in_vain = {what, in_vain ? in_vain->at : now, last_in_vain.lease_end}, kept = last_in_vain;
    const bool ends = now > lease_end - kReordered;
    if (ends) at_end = {what, now, now + std::chrono::seconds(lease_seconds)};
    words.push_back({word_of(what), ends ? std::nullopt : std::optional(described_at)});
}

SimAgent::SimAgent(SimBroker& broker, Dice& dice, std::string board, BoardTruth& truth, int lease_seconds,
                   bool says_state)
    : broker_(broker),
      dice_(dice),
      board_(std::move(board)),
      description_topic_(topics_.description(board_)),
      truth_(truth),
      lease_seconds_(lease_seconds),
      says_state_(says_state) {
    truth_.agents.push_back(this);
}

asip::Random SimAgent::random() {
    return [this] { return dice_.draw(); };
}

void SimAgent::describe() {
    asip::model::Description description;
    description.services.resize(1);
    description.services[0].name = description.services[0].model = "io";
    description.services[0].model += "@1";
    announcer_->describe(std::move(description));
}

void SimAgent::start(std::int64_t clock_skew, bool takeover, Time now) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now.time_since_epoch()).count();
    asip::member::AnnouncerOptions options;
    options.board = board_;
    options.lease_seconds = lease_seconds_;
    options.takeover = takeover;
    options.started_unix =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(kStartOfTime) + seconds + clock_skew);
    announcer_ = std::make_unique<asip::member::Announcer>(topics_, options, random());
    identified_ = false;
    if (asip::model::is_there(state_)) becomes(BoardState::kOnline, StateReason::kNone, now);
    connect(now);
}

void SimAgent::connect(Time now) {
    client_ =
        broker_.connect([this](const Message& message, Time at) { take(message, at); }, announcer_->will());
    for (const auto& one : announcer_->subscriptions())
        broker_.subscribe(client_, one.filter, one.options.no_local, one.options.retained, now);
    Announcements out;
    announcer_->on_connected(now, out);
    announcer_->on_subscribed(now, out);
    perform(out, now);
}

void SimAgent::stop(Time now) {
    if (!runs()) return;
    Announcements out;
    announcer_->goodbye(now, out);
    const bool told = client_ != 0 && !out.publish.empty();
    perform(out, now);
    if (told && truth_.session == announcer_->session())
        truth_.say({true, BoardState::kOffline, StateReason::kStopped, now, now});
    broker_.end(std::exchange(client_, 0), false, now);
    announcer_.reset();
}

void SimAgent::kill(Time now) {
    if (!runs()) return;
    announcer_.reset();
    if (client_ == 0) return;
    const auto client = std::exchange(client_, 0);
    broker_.end(client, true, now);
    truth_.word(BoardState::kLost, client, now);
}

void SimAgent::cut_off(Time now) {
    if (!runs() || client_ == 0) return;
    announcer_->on_disconnected();
    lingering_ = std::exchange(client_, 0);
    will_due_ = now + std::chrono::milliseconds(dice_.between(2000, 40'000));
}

void SimAgent::lose_broker(Time now) {
    announcer_->on_disconnected();
    broker_.end(std::exchange(client_, 0), false, now);
}

void SimAgent::heal(Time now) {
    if (is_cut_off()) connect(now);
}

void SimAgent::becomes(BoardState state, StateReason reason, Time now) {
    const bool changes = state_ != state || reason_ != reason || !identified_;
    state_ = state;
    reason_ = reason;
    if (changes) since_ = now;
    if (!runs()) return;
    if (!identified_ && state != BoardState::kOnline) return;
    Announcements out;
    if (!std::exchange(identified_, true)) describe();
    announcer_->set_state(state, reason, now, out);
    perform(out, now);
}

void SimAgent::take(const Message& message, Time now) {
    if (!announcer_ || client_ == 0) return;  // of a connection that is cut, nothing arrives
    Announcements out;
    announcer_->on_message(message, now, out);
    perform(out, now);
}

void SimAgent::tick(Time now) {
    if (will_due_ && now >= *will_due_) {
        broker_.end(lingering_, true, now);
        truth_.word(BoardState::kLost, lingering_, now);
        will_due_.reset();
    }
    if (!announcer_) return;
    const auto due = announcer_->next_deadline();
    if (!due || now < *due) return;
    Announcements out;
    announcer_->tick(now, out);
    perform(out, now);
}

std::optional<Time> SimAgent::next() const {
    auto due = announcer_ ? announcer_->next_deadline() : std::nullopt;
    if (will_due_ && (!due || *will_due_ < *due)) due = will_due_;
    return due;
}

void SimAgent::perform(Announcements& out, Time now) {
    for (auto& publication : out.publish) {
        auto& message = publication.message;
        if (message.topic == description_topic_) {
            // What older agents say on `$state` is of no session.
            const Really what{true, state_, reason_, since_, now};
            if (!says_state_ || truth_.counts(announcer_->session(), now)) {
                truth_.describe(what, announcer_->session(), client_, lease_seconds_, message.retain, now);
            } else {
                truth_.describe_in_vain(what, lease_seconds_, message.retain, now);
            }
            if (!says_state_) leave_out_state(message.payload);
        }
        // A word on `$state` is of no session: that of an agent that is not believed is taken for a will.
        if (message.topic.ends_with("/$state")) {
            const auto state = *asip::model::board_state_from_text(message.payload);
            if (message.retain)
                truth_.kept_word = {true, state, asip::model::reason_of_word(state), now, now};
            if (truth_.session != announcer_->session() && !asip::model::is_there(state))
                truth_.word(state, client_, now);
        }
        if (client_ != 0) broker_.publish(client_, std::move(message), now);
    }
    if (!out.fatal) return;
    // Another agent has the name now.
    broker_.end(std::exchange(client_, 0), false, now);
    announcer_.reset();
}

}  // namespace truth::presence
