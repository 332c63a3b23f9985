// SPDX-License-Identifier: Apache-2.0
#include "asip/session/interview.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "asip/model/names.hpp"
#include "asip/protocol/message.hpp"
#include "asip/protocol/request.hpp"

namespace asip::session {

namespace {

constexpr std::array<std::string_view, 9> kQuestions{
    protocol::kAskInfo,      protocol::kAskExtensions,      protocol::kAskServiceNames,
    protocol::kAskPinOwners, protocol::kAskPortMap,         protocol::kAskAnalogMap,
    protocol::kAskPinModes,  protocol::kAskPinCapabilities, protocol::kAskIdentity,
};

constexpr int kTries = 3;
// Errors that name no question of ours: they may be about what was sent before, and come in numbers.
constexpr int kTriesAtOnce = 3;
// A board that answered nothing to "#,X" is asked once more from the start: it may have stood still, and what
// it is able to do decides how far its answers can be believed.
constexpr int kRounds = 2;
// A damaged "#,X" may be refused, too.
constexpr int kRefusals = 2;

// Without them a board is of no use: a board that stood still is asked for them once more.
constexpr bool is_essential(std::string_view question) {
    return question == protocol::kAskServiceNames || question == protocol::kAskPortMap;
}

template <class T>
bool keep(Expected<T> parsed, T& place) {
    if (!parsed) return false;
    place = std::move(*parsed);
    return true;
}

}  // namespace

const protocol::ServiceName* Identity::find_service(char letter) const {
    auto it = std::find_if(services.begin(), services.end(), [&](const auto& s) { return s.id == letter; });
    return it == services.end() ? nullptr : &*it;
}

bool same_board(const Identity& a, const Identity& b) {
    return a.info.major == b.info.major && a.info.minor == b.info.minor && a.info.chip == b.info.chip &&
           a.info.pins == b.info.pins && a.info.sketch == b.info.sketch && a.stored_name == b.stored_name &&
           a.services == b.services && a.extensions == b.extensions && a.pin_owners == b.pin_owners;
}

bool is_other_board(const Identity& a, const Identity& b) {
    return a.info.chip != b.info.chip || a.info.sketch != b.info.sketch || a.stored_name != b.stored_name;
}

Interview::Interview(std::string services, bool with_checksums, Time now, std::vector<std::string>& lines)
    : turn_checksums_on_(with_checksums), banner_services_(std::move(services)) {
    static_assert(kQuestionCount == kQuestions.size());
    ask(now, lines);
}

void Interview::ask(Time now, std::vector<std::string>& lines) {
    asked_ = now;
    ++tries_;
    lines.emplace_back(kQuestions[step_]);
}

void Interview::repeat(Time now, std::vector<std::string>& lines) {
    if (progress_ != Progress::kAsking) return;
    tries_ = tries_at_once_ = 0;
    ask(now, lines);
}

void Interview::ask_again_or_pass(Time now, std::vector<std::string>& lines) {
    if (tries_ < kTries) return ask(now, lines);
    if (kQuestions[step_] != protocol::kAskExtensions || ++rounds_ == kRounds) return pass(false, now, lines);
    start_again(now, lines);
}

void Interview::start_again(Time now, std::vector<std::string>& lines) {
    identity_ = Identity{};
    unanswered_ = {};
    once_more_ = false;
    step_ = 0;
    tries_ = tries_at_once_ = 0;
    ask(now, lines);
}

// Leaves the question unanswered.
void Interview::pass(bool refused, Time now, std::vector<std::string>& lines) {
    unanswered_[step_] = !refused;
    if (step_ == 0)
        progress_ = Progress::kFailed;
    else
        next(now, lines);
}

bool Interview::skip_step() const {
    if (once_more_) return !unanswered_[step_] || !is_essential(kQuestions[step_]);
    return kQuestions[step_] == protocol::kAskIdentity && !identity_.extensions.has(protocol::kIdentity);
}

void Interview::next(Time now, std::vector<std::string>& lines) {
    tries_ = tries_at_once_ = 0;
    const auto& extensions = identity_.extensions;
    if (turn_checksums_on_ && extensions.has(protocol::kChecksum) && extensions.has(protocol::kEcho)) {
        turn_checksums_on_ = false;
        lines.push_back(protocol::set_checksum(true));
        return start_again(now, lines);
    }
    do {
        if (++step_ < kQuestions.size()) continue;
        if (std::exchange(once_more_, true)) return finish();
        step_ = 1;
    } while (skip_step());
    ask(now, lines);
}

void Interview::finish() {
    if (identity_.services.empty())
        for (char letter : banner_services_)
            if (letter >= 'A' && letter <= 'Z' && !identity_.find_service(letter))
                identity_.services.push_back({letter, {}});
    progress_ = Progress::kDone;
}

bool Interview::take_of_core(const protocol::Event& event) {
    switch (event.tag) {
        case 'M':
            return keep(protocol::PortMap::parse(event.body), identity_.port_map);
        case 'm':
            return keep(protocol::parse_analog_map(event.body), identity_.analog_pins);
        case 'p':
            return keep(protocol::parse_pin_modes(event.body), identity_.pin_modes);
        case 'c':
            return keep(protocol::parse_pin_capabilities(event.body), identity_.pin_capabilities);
        default:
            return false;
    }
}

// Where something is missing it may have been damaged: only what comes twice is believed.
bool Interview::take_extensions(std::string_view body) {
    auto extensions = protocol::parse_extensions(body);
    if (!extensions) return false;
    const bool complete = extensions->has(protocol::kEcho) && extensions->has(protocol::kVerifiedFence);
    if (!complete && std::exchange(extensions_, *extensions) != *extensions) return false;
    identity_.extensions = std::move(*extensions);
    return true;
}

bool Interview::take(const protocol::Event& event) {
    if (event.service == 'I') return take_of_core(event);
    switch (event.tag) {
        case '?':
            return keep(protocol::parse_board_info(event.body), identity_.info);
        case 'X':
            return take_extensions(event.body);
        case 'N': {
            auto names = protocol::parse_service_names(event.body);
            if (!names) return false;
            for (auto& name : *names)
                if (!identity_.find_service(name.id)) identity_.services.push_back(std::move(name));
            return true;
        }
        case 'S':
            return keep(protocol::parse_pin_owners(event.body), identity_.pin_owners);
        case 'I':
            if (model::valid_board_name(event.body)) identity_.stored_name = event.body;
            return true;
        default:
            return false;
    }
}

void Interview::note_answer(std::size_t step) {
    unanswered_[step] = false;
    if (kQuestions[step] == protocol::kAskServiceNames || (step > 0 && other_question_.empty()))
        other_question_ = kQuestions[step];
}

// To a question that was asked for long enough without one.
bool Interview::take_late(const protocol::Event& event) {
    for (std::size_t i = 0; i < kQuestions.size(); ++i) {
        if (!unanswered_[i] || i == step_ || event.service != kQuestions[i][0] ||
            event.tag != kQuestions[i][2])
            continue;
        if (take(event)) note_answer(i);
        return true;
    }
    return false;
}

bool Interview::on_event(const protocol::Event& event, Time now, std::vector<std::string>& lines) {
    if (progress_ != Progress::kAsking) return false;
    const std::string_view question = kQuestions[step_];
    if (event.service != question[0] || event.tag != question[2]) return take_late(event);
    // A damaged answer is asked for again at once, while tries are left.
    if (!take(event)) {
        ask_again_or_pass(now, lines);
        return true;
    }
    note_answer(step_);
    next(now, lines);
    return true;
}

bool Interview::on_error(const protocol::ErrorReply& error, Time now, std::vector<std::string>& lines) {
    if (progress_ != Progress::kAsking) return false;
    const std::string_view question = kQuestions[step_];
    const bool named = error.service == question[0] && error.tag == question[2];
    if (!named && error.service != '#' && error.service != 'Q' && error.tag != '?') return false;
    if (named) {
        const bool damaged = error.code == static_cast<int>(protocol::ErrorCode::kBadArgument);
        const bool believed = question != protocol::kAskExtensions || (!damaged && ++refusals_ == kRefusals);
        damaged || !believed ? ask_again_or_pass(now, lines) : pass(true, now, lines);
    } else if (tries_at_once_ < kTriesAtOnce) {  // our question may have been damaged
        ++tries_at_once_;
        --tries_;
        ask(now, lines);
    }
    return true;
}

void Interview::on_deadline(Time now, Duration answer_timeout, std::vector<std::string>& lines) {
    if (progress_ == Progress::kAsking && now >= asked_ + answer_timeout) ask_again_or_pass(now, lines);
}

std::string Interview::other_question() const {
    return other_question_.empty() ? std::string(protocol::kAskServiceNames) : other_question_;
}

}  // namespace asip::session
