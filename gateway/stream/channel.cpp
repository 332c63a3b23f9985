// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/channel.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/json/json_text.hpp"
#include "asip/model/json.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxRefBytes = 64;

// The ref of a request as JSON text: a short string, or a number as `message` has it.
std::string ref_of(const json& request, const char* member, std::string_view message) {
    const auto found = request.find(member);
    if (found == request.end()) return "null";
    if (found->is_number_float()) {
        const auto written = bus::written_member(message, member);
        return written.empty() || written.size() > kMaxRefBytes ? "null" : std::string(written);
    }
    const bool fits = found->is_number() ||
                      (found->is_string() && found->get_ref<const std::string&>().size() <= kMaxRefBytes);
    return fits ? model::dump_json(*found) : "null";
}

std::string error_text(const std::string& ref, const std::string& sentence) {
    return "{\"ref\":" + ref + ",\"error\":" + model::dump_json(json(sentence)) + "}";
}

}  // namespace

StreamChannel::StreamChannel(Streams& streams, Dependencies dependencies, Principal principal,
                             std::string client)
    : OpenStream(std::move(principal), std::move(client)),
      streams_(streams),
      dependencies_(std::move(dependencies)),
      base_bytes_(dependencies_.part.bytes()) {
    streams_.add(*this);
}

StreamChannel::~StreamChannel() {
    *alive_ = false;
    streams_.remove(*this);
}

void StreamChannel::answer(std::string text) {
    // Asks on and on, and does not read.
    if (!count_answers(answer_bytes_ + kBytesOfAnswer + text.size())) return revoke();
    answers_.push_back(std::move(text));
    wake();
}

bool StreamChannel::count_answers(std::size_t bytes) {
    if (!dependencies_.part.set(base_bytes_ + std::max(bytes, kBytesOfAnswers) - kBytesOfAnswers))
        return false;
    answer_bytes_ = bytes;
    return true;
}

bool StreamChannel::fault(const std::string& ref, const std::string& sentence) {
    answer(error_text(ref, sentence));
    return ++faults_ < kMaxFaults;
}

bool StreamChannel::received(std::string_view message) {
    if (revoked_) return false;  // it came before the end did
    auto request = model::parse_json(message);
    if (!request) return fault("null", "not JSON: " + request.error());
    if (!request->is_object()) return fault("null", "a message is a JSON object");
    const int kinds = static_cast<int>(request->contains("subscribe")) +
                      static_cast<int>(request->contains("unsubscribe")) +
                      static_cast<int>(request->contains("command"));
    if (kinds != 1)
        return fault(ref_of(*request, "ref", message), "one of subscribe, unsubscribe and command is needed");
    bus::keep_numbers(message, *request, {"id", "renew"});
    handle(*request, message);
    return true;
}

void StreamChannel::handle(const json& request, std::string_view message) {
    if (request.contains("subscribe")) return subscribe(request, message);
    if (request.contains("unsubscribe")) return unsubscribe(request, message);
    dependencies_.command(request, [this, alive = std::weak_ptr<bool>(alive_)](std::string text) {
        if (const auto still = alive.lock(); still && *still) answer(std::move(text));
    });
}

void StreamChannel::subscribe(const json& request, std::string_view message) {
    const auto ref = ref_of(request, "ref", message);
    if (ref == "null") return void(fault(ref, "ref: a number or a string of at most 64 bytes"));
    for (const auto& each : subscriptions_)
        if (each.ref == ref) return void(fault(ref, "ref: in use; unsubscribe first"));
    if (subscriptions_.size() >= dependencies_.max_subscriptions)
        return void(fault(ref, "too many subscriptions on this connection"));
    auto feed = dependencies_.subscribe(request);
    if (!feed) return void(fault(ref, feed.error()));
    if (const auto why = (*feed)->fault(); !why.empty()) return void(fault(ref, std::string(why)));
    answer("{\"ref\":" + ref + ",\"ok\":true}");
    auto& made = subscriptions_.emplace_back(Subscription{ref, std::move(*feed), false});
    made.feed->wake = [this, &made] {
        made.idle = false;
        wake();
    };
    wake();
}

void StreamChannel::unsubscribe(const json& request, std::string_view message) {
    const auto ref = ref_of(request, "unsubscribe", message);
    const auto found = std::find_if(subscriptions_.begin(), subscriptions_.end(),
                                    [&](const Subscription& each) { return each.ref == ref; });
    if (found == subscriptions_.end()) return void(fault(ref, "there is no subscription of this ref"));
    subscriptions_.erase(found);
    answer("{\"ref\":" + ref + ",\"ok\":true}");
}

bool StreamChannel::take(std::string& message) {
    if (!answers_.empty()) {
        message = std::move(answers_.front());
        answers_.pop_front();
        count_answers(answer_bytes_ - kBytesOfAnswer - message.size());
        return true;
    }
    return next_event(message);
}

// In turn: a subscription with much to send does not keep the others waiting.
bool StreamChannel::next_event(std::string& message) {
    const auto now = dependencies_.now();
    StreamEvent event;
    more_ = false;
    for (std::size_t turns = subscriptions_.size(); turns > 0; --turns) {
        subscriptions_.splice(subscriptions_.end(), subscriptions_, subscriptions_.begin());
        auto& subscription = subscriptions_.back();
        if (subscription.idle) continue;
        if (subscription.feed->next(event, now)) {
            message = websocket_message(event, subscription.ref);
            return true;
        }
        if (const auto why = subscription.feed->fault();
            !why.empty() && !std::exchange(subscription.over, true)) {
            message = error_text(subscription.ref, std::string(why));
            return true;
        }
        // Its next page is another turn's, and this turn is over.
        if (more_ = subscription.feed->more(); more_) return false;
        subscription.idle = true;
    }
    return false;
}

void StreamChannel::tick(const Instant& now) {
    // Not when it was told: then values may be calling their feeds.
    std::erase_if(subscriptions_, [](const Subscription& each) { return each.over; });
    for (auto& subscription : subscriptions_)
        subscription.feed->tick(now);
}

void StreamChannel::revoke() {
    revoked_ = true;
    wake();
}

}  // namespace asip::gateway
