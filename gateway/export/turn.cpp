// SPDX-License-Identifier: Apache-2.0
#include "gateway/export/turn.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"

namespace asip::gateway::exports {
namespace {

using nlohmann::json;

constexpr std::uint64_t kJitterMs = 500;

std::string text_of(const json& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<Turn::Holder> read(std::string_view payload) {
    const auto object = model::parse_json(payload, {.max_bytes = Turn::kMaxBytes, .max_depth = 2});
    if (!object || !object->is_object()) return std::nullopt;
    Turn::Holder holder{text_of(*object, "gateway"), 0, text_of(*object, "host"), {}};
    if (const auto places = object->find("places"); places != object->end() && places->is_array())
        for (const auto& place : *places)
            if (place.is_string() && holder.places.size() < Turn::kMaxPlaces)
                holder.places.insert(place.get<std::string>());
    const auto term = object->find("term");
    if (holder.gateway.empty() || term == object->end() || !term->is_number_unsigned()) return std::nullopt;
    holder.term = term->get<std::uint64_t>();
    return holder;
}

bool before(const Turn::Holder& a, const Turn::Holder& b) {
    return a.term != b.term ? a.term > b.term : a.gateway < b.gateway;
}

}  // namespace

std::string Turn::text() const {
    return model::dump_json(
        {{"gateway", self_.gateway}, {"term", self_.term}, {"host", self_.host}, {"places", self_.places}});
}

void Turn::subscribed(Time now) {
    heard_since_ = now;
    last_sign_ = now;
    not_before_ = now + kSettle + std::chrono::milliseconds(random_() % kJitterMs);
}

bool Turn::said(std::string_view payload, bool retained, Time now) {
    const auto holder = read(payload);
    if (!holder) {
        if (active_) {
            renew_at_ = now;
        } else if (payload.empty()) {  // by its holder at the end, or by anybody: then it says so again
            holder_gone_ = true;
            not_before_ =
                std::max(not_before_, now + kSettle + std::chrono::milliseconds(random_() % kJitterMs));
        }
        return false;
    }
    if (holder->gateway == self_.gateway) return false;
    if (active_) {
        if (!before(*holder, self_)) {
            renew_at_ = now;  // it has not heard of ours
            return false;
        }
        active_ = false;
    } else if (holder_ && before(*holder_, *holder) && !retained && held(now)) {
        return false;  // of one that gives way
    }
    holder_ = holder;
    last_sign_ = now;
    if (!retained) holder_gone_ = false;
    return true;
}

void Turn::state(std::string_view payload, Time now) {
    if (payload == "offline" && !holder_gone_) {
        holder_gone_ = true;
        not_before_ = std::max(not_before_, now + std::chrono::milliseconds(random_() % kJitterMs));
    } else if (payload == "online") {
        holder_gone_ = false;
        last_sign_ = now;
    }
}

bool Turn::held(Time now) const {
    return holder_ && !holder_gone_ && now - last_sign_ < kStale;
}

bool Turn::may_claim(Time now) const {
    return !active_ && heard_since_ && now >= not_before_ && !held(now);
}

std::string Turn::claim(Time now) {
    self_.term = next_term();
    // Until what is elsewhere is cleared: a gateway that starts after a crash must find it.
    if (holder_) self_.places.insert(holder_->places.begin(), holder_->places.end());
    holder_ = self_;
    holder_gone_ = false;
    active_ = true;
    renew_at_ = now + kRenewal;
    return text();
}

std::optional<std::string> Turn::renewal(Time now) {
    if (!active_ || now < renew_at_) return std::nullopt;
    renew_at_ = now + kRenewal;
    return text();
}

}  // namespace asip::gateway::exports
