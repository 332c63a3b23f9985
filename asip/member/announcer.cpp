// SPDX-License-Identifier: Apache-2.0
#include "asip/member/announcer.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <utility>

#include "asip/bus/request/request_envelope.hpp"
#include "asip/program/exit_status.hpp"

namespace asip::member {

namespace {

// A probe is answered within a second, at a random moment; the rest is the way there and back.
constexpr Duration kClaimTime = std::chrono::milliseconds(1300);
constexpr Duration kProbeAnswer = std::chrono::milliseconds(900);
constexpr Duration kBetweenChanges = std::chrono::seconds(1);
// However many probes come.
constexpr Duration kBetweenAnswers = std::chrono::milliseconds(500);
constexpr std::size_t kMaxSessionBytes = 64;
// A lease outlives a renewal that is lost, and acknowledgements cost a broker as much as the message.
constexpr int kRenewalQos = 0;

std::string make_session(std::uint64_t started_unix, const Random& random) {
    char time[24];
    std::snprintf(time, sizeof time, "%010llx", static_cast<unsigned long long>(started_unix));
    return time + random_hex(random, 6);
}

// Later than `other`, which a program whose clock went back may find stored.
std::string session_behind(const std::string& other, std::uint64_t started_unix, const Random& random) {
    constexpr std::uint64_t kMaxTime = 0xffffffffff;
    std::uint64_t time = 0;
    const auto end =
        std::from_chars(other.data(), other.data() + std::min<std::size_t>(other.size(), 10), time, 16);
    const bool has_time = other.size() >= 16 && end.ptr == other.data() + 10;
    if (has_time && time < kMaxTime) return make_session(std::max(started_unix, time + 1), random);
    return other.size() + 5 <= kMaxSessionBytes ? other + "-" + random_hex(random, 4) : other;
}

mqtt::Message plain(std::string topic, std::string payload) {
    return mqtt::Message{.topic = std::move(topic), .payload = std::move(payload), .qos = 1};
}

// A stored description proves no living agent, nor does a goodbye.
bool proves_life(const mqtt::Message& message, const model::Description& other) {
    return !message.retain && !(other.state && other.state->state == model::BoardState::kOffline);
}

Duration random_part(Duration of, const Random& random) {
    return std::chrono::duration_cast<Duration>(of * random_unit(random));
}

}  // namespace

mqtt::Message retained(std::string topic, std::string payload) {
    return mqtt::Message{.topic = std::move(topic), .payload = std::move(payload), .qos = 1, .retain = true};
}

std::vector<std::string> take_stray_answers(Publications& publish, const bus::Topics& topics,
                                            std::string_view board) {
    std::vector<std::string> taken;
    std::erase_if(publish, [&](const Publication& each) {
        const bool answer =
            each.priority == mqtt::Priority::kReply || each.priority == mqtt::Priority::kUrgent;
        if (!answer || bus::may_answer_on(each.message.topic, topics, board)) return false;
        taken.push_back(each.message.topic);
        return true;
    });
    return taken;
}

Announcer::Announcer(const bus::Topics& topics, AnnouncerOptions options, Random random)
    : topics_(topics),
      options_(std::move(options)),
      random_(std::move(random)),
      session_(make_session(options_.started_unix, random_)) {}

mqtt::Message Announcer::will() const {
    auto will = retained(topics_.state(options_.board), std::string(to_text(model::BoardState::kLost)));
    will.expiry_seconds = model::kStateExpirySeconds;
    return will;
}

/// Only descriptions and probes of others matter: each of ours would come back otherwise. Of states our
/// own will, too, which the broker may hold for a message of ours. A stored description may be of a session
/// that is later than ours, as a clock went back.
std::vector<Announcer::Subscription> Announcer::subscriptions(const bus::Topics& topics,
                                                              const std::string& board) {
    return {{topics.state(board), {.qos = 1}},
            {topics.description(board), {.qos = 1, .no_local = true}},
            {topics.probe(), {.qos = 0, .no_local = true}}};
}

void Announcer::describe(model::Description description) {
    description_ = std::move(description);
    description_.board = options_.board;
    description_.lease = options_.lease_seconds;
    described_ = true;
    retained_until_.reset();
    // At the next tick, so that many changes are one announcement, and at most once a second.
    if (established_ && connected_) probe_answer_ = last_announced_ + kBetweenChanges;
}

void Announcer::set_updating(std::string json) {
    if (updating_ == json) return;
    updating_ = std::move(json);
    retained_until_.reset();
    if (established_ && connected_) probe_answer_ = last_announced_ + kBetweenChanges;
}

void Announcer::set_state(model::BoardState state, model::StateReason reason, Time now, Announcements& out) {
    if (state_ == state && reason_ == reason) return;
    state_ = state;
    reason_ = reason;
    state_since_ = now;
    retained_until_.reset();
    if (!established_ || !connected_) return;
    const bool names = probe_answer_.has_value();
    if (announce_board(now, out) && names) names_ = now;
}

void Announcer::publish_state(bool retain, Announcements& out) {
    auto state = retained(topics_.state(options_.board), std::string(to_text(state_)));
    // No session is told by this word: each program takes one that the board is gone.
    state.retain = retain || !is_there(state_);
    state.expiry_seconds = model::kStateExpirySeconds;
    state_said_ = true;
    out.publish.push_back({std::move(state), mqtt::Priority::kAnnouncement});
}

void Announcer::on_connected(Time now, Announcements& out, bool expires) {
    connected_ = true;
    expires_ = expires;
    if (established_ && !challenge_) return;
    if (challenge_)
        challenge_->ends = now + kClaimTime;
    else
        claim_ends_ = now + kClaimTime;
    out.publish.push_back({plain(topics_.probe(), options_.board), mqtt::Priority::kAnnouncement});
}

void Announcer::on_disconnected() {
    connected_ = subscribed_ = state_said_ = false;  // a challenge begins again with the next connection
    claim_ends_.reset();
    renewal_.reset();
    probe_answer_.reset();
    names_.reset();
    retained_until_.reset();
}

void Announcer::on_subscribed(Time now, Announcements& out) {
    if (!connected_ || std::exchange(subscribed_, true) || !established_) return;
    // Commands wait behind what is sent now: of all members of a broker that is gone, at the same moment.
    if (announce_board(now, out)) names_ = now + random_part(kProbeAnswer, random_);
}

std::string Announcer::description_text() const {
    auto text = model::to_text(description_);
    if (!updating_.empty()) text.insert(text.size() - 1, ",\"updating\":" + updating_);
    return text;
}

void Announcer::announce(Time now, Announcements& out) {
    if (announce_board(now, out)) publish_names(out);
}

bool Announcer::announce_board(Time now, Announcements& out) {
    const bool retain = retains(now);
    if (!publish_description(1, retain, now, out)) return false;
    publish_state(retain, out);
    return true;
}

void Announcer::publish_names(Announcements& out) {
    names_.reset();
    if (options_.on_shared_topic)
        out.publish.push_back({plain(topics_.board_names(), options_.board), mqtt::Priority::kAnnouncement});
    for (const auto& service : description_.services)
        out.publish.push_back(
            {plain(topics_.service_names(options_.board), service.name), mqtt::Priority::kAnnouncement});
}

bool Announcer::publish_description(int qos, bool retain, Time now, Announcements& out) {
    probe_answer_.reset();
    renewal_.reset();
    if (!subscribed_) return false;
    last_announced_ = now;
    schedule_renewal(now);
    if (!described_) return false;
    description_.session = session_;
    description_.seq = ++seq_;
    if (state_since_ == Time{}) state_since_ = now;
    const auto age = std::chrono::duration<double>(now - state_since_).count();
    description_.state = model::SaidState{state_, reason_, std::clamp(age, 0.0, model::kMaxStateAgeSeconds)};
    mqtt::Message description = retained(topics_.description(options_.board), description_text());
    description.qos = qos;
    description.retain = retain;
    if (retain) retained_until_ = now + std::chrono::seconds(options_.lease_seconds);
    description.expiry_seconds = static_cast<std::uint32_t>(options_.lease_seconds);
    out.publish.push_back({std::move(description), mqtt::Priority::kAnnouncement});
    return true;
}

void Announcer::schedule_renewal(Time now) {
    const Duration third = std::chrono::seconds(options_.lease_seconds) / Duration::rep{3};
    renewal_ = now + third - random_part(third / 5, random_);
}

void Announcer::announce_within(Duration limit, Time now) {
    const Time when = std::max(now + random_part(limit, random_), last_announced_ + kBetweenAnswers);
    if (!probe_answer_ || when < *probe_answer_) probe_answer_ = when;
}

void Announcer::on_message(const mqtt::Message& message, Time now, Announcements& out) {
    const auto topic = topics_.parse(message.topic);
    if (!topic) return;
    if (topic->kind == bus::TopicKind::kProbe) {
        const bool yields = options_.name_of_board && state_ == model::BoardState::kLost;
        if (established_ && (message.payload.empty() || (message.payload == options_.board && !yields)))
            announce_within(kProbeAnswer, now);
        return;
    }
    if (topic->board != options_.board) return;
    if (topic->kind == bus::TopicKind::kDescription) return on_foreign_description(message, now, out);
    if (topic->kind != bus::TopicKind::kState || !established_ || (message.retain && !state_said_) ||
        message.payload == to_text(state_))
        return;
    // Our own words of a moment ago come back, too; saying the newest once more does no harm.
    out.log(program::log::Level::kDebug, "state put right", {{"was", message.payload.substr(0, 32)}});
    retained_until_.reset();  // the broker keeps the other word now
    announce_board(now, out);
}

void Announcer::on_foreign_description(const mqtt::Message& message, Time now, Announcements& out) {
    const auto other = model::parse_description(message.payload);
    if (other && other->session == session_) return;
    if (message.retain && (!other || other->session < session_)) return;
    if (!established_ && other && !proves_life(message, *other)) {
        if (session_ < other->session)
            session_ = session_behind(other->session, options_.started_unix, random_);
        return;
    }
    retained_until_.reset();
    if (!other) {  // somebody emptied it: programs take this board for forgotten
        if (established_) announce_within(kProbeAnswer, now);
        return;
    }
    const std::string holder = "agent " +
                               (other->agent.client.empty() ? other->session : other->agent.client) +
                               (other->agent.host.empty() ? "" : " on " + other->agent.host);
    if (established_ && other->session < session_) return announce_within(kProbeAnswer, now);
    if (established_) return challenge(*other, proves_life(message, *other), holder, now, out);
    if (options_.takeover) {
        if (session_ < other->session)
            session_ = session_behind(other->session, options_.started_unix, random_);
        return;
    }
    out.fatal = Fatal{program::kExitNameConflict,
                      "the board name \"" + options_.board + "\" is held by " + holder +
                          "; give this board another one with --name, or take the name with --takeover"};
}

void Announcer::challenge(const model::Description& other, bool lives, const std::string& holder, Time now,
                          Announcements& out) {
    if (!challenge_ || challenge_->session != other.session) {
        challenge_ = Challenge{other.session, other.seq, holder, now + kClaimTime};
        out.publish.push_back({plain(topics_.probe(), options_.board), mqtt::Priority::kAnnouncement});
        return;
    }
    if (other.seq <= challenge_->seq || !lives) return;
    out.fatal = Fatal{program::kExitNameConflict,
                      "the board name \"" + options_.board + "\" was taken over by " + holder};
}

void Announcer::tick(Time now, Announcements& out) {
    if (challenge_ && connected_ && now >= challenge_->ends) {
        out.log(program::log::Level::kWarning,
                "an announcement of this board came from no living agent; putting it right",
                {{"from", challenge_->holder}});
        // Ours has to be the later session, or no program believes it.
        session_ = session_behind(challenge_->session, options_.started_unix, random_);
        challenge_.reset();
        retained_until_.reset();
        announce_within(Duration{}, now);
    }
    if (claim_ends_ && now >= *claim_ends_) {
        claim_ends_.reset();
        established_ = true;
        return announce(now, out);
    }
    if (!established_ || !connected_) return;
    if (probe_answer_ && now >= *probe_answer_) return announce(now, out);
    if (names_ && now >= *names_) publish_names(out);
    if (renewal_ && now >= *renewal_) publish_description(kRenewalQos, retains(now), now, out);
}

std::optional<Time> Announcer::next_deadline() const {
    std::optional<Time> deadline = claim_ends_;
    if (challenge_ && connected_ && (!deadline || challenge_->ends < *deadline)) deadline = challenge_->ends;
    for (const auto& other : {renewal_, probe_answer_, names_})
        if (other && (!deadline || *other < *deadline)) deadline = other;
    return deadline;
}

void Announcer::goodbye(Time now, Announcements& out) {
    if (established_) set_state(model::BoardState::kOffline, model::StateReason::kStopped, now, out);
    established_ = false;
    renewal_.reset();
    probe_answer_.reset();
    names_.reset();
    claim_ends_.reset();
    challenge_.reset();
}

}  // namespace asip::member
