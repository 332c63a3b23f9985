// SPDX-License-Identifier: Apache-2.0
#include "asip/property/known_values.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "asip/property/value.hpp"

namespace asip::property {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxHeard = 1024;
constexpr const char* kPinEvents[] = {"digital", "analog"};

bool is_read_or_set_alike(const Property& a, const Property& b) {
    return a.read == b.read && a.write == b.write && a.color == b.color && a.floating == b.floating;
}

std::string level_key(std::string_view io, int pin) {
    return std::string(io) + "/digital/" + std::to_string(pin);
}

std::optional<double> number_of(const json& value) {
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

}  // namespace

std::string_view to_text(How how) {
    switch (how) {
        case How::kReported:
            return "reported";
        case How::kAnswered:
            return "answered";
        case How::kSet:
            return "set";
        case How::kNone:
            break;
    }
    return "unknown";
}

std::string_view to_text(Unknown why) {
    switch (why) {
        case Unknown::kRestart:
            return "restart";
        case Unknown::kDoubt:
            return "doubt";
        case Unknown::kNever:
            break;
    }
    return "never";
}

void KnownValues::use(std::vector<Property> properties, Time now) {
    std::vector<Raw> raws(properties.size());
    for (std::size_t i = 0; i < properties.size(); ++i) {
        auto& raw = raws[i];
        raw.since = now;
        const auto& property = properties[i];
        bool known = false;
        for (std::size_t old = 0; !known && old < properties_.size(); ++old) {
            known = properties_[old].id == property.id && is_read_or_set_alike(properties_[old], property);
            if (known) raw = std::move(raws_[old]);
            if (known && properties_[old].meaning != property.meaning) raw.contact.let_go();
        }
        if (known || !property.read || property.floating) continue;
        const auto heard = pins_.find(property.read->service + property.read->pointer);
        if (heard != pins_.end())
            take(property, raw, heard->second.value, How::kReported, heard->second.when);
    }
    properties_ = std::move(properties);
    raws_ = std::move(raws);
}

bool KnownValues::take(const Property& property, Raw& raw, const json& value, How how, Time now) {
    if (property.read && property.read->sum) {
        if (!value.is_number()) return false;
        raw.sum += value.get<double>();
        const bool changed = raw.how == How::kNone || value.get<double>() != 0;
        raw.value = json_number(raw.sum);
        raw.how = how;
        raw.since = now;
        return changed;
    }
    if (how != How::kSet && !has_value(property, value)) return false;
    const bool changed = raw.how != how || raw.value != value;
    raw.value = value;
    raw.how = how;
    raw.since = now;
    return changed;
}

bool KnownValues::lose(Raw& raw, Unknown why, Time now) {
    if (raw.how == How::kNone && raw.why == why) return false;
    raw = Raw{{}, {}, How::kNone, why, now};
    return true;
}

bool KnownValues::reported(std::string_view service, const json& published, How how, Time now) {
    if (!published.is_object()) return false;
    for (const auto& [event, pins] : published.get_ref<const json::object_t&>()) {
        if (!pins.is_object() ||
            std::find(std::begin(kPinEvents), std::end(kPinEvents), event) == std::end(kPinEvents))
            continue;
        const auto place = std::string(service) + "/" + event + "/";
        for (const auto& [pin, value] : pins.items())
            if (pins_.size() < kMaxHeard) pins_.insert_or_assign(place + pin, Heard{value, now});
    }
    bool changed = false;
    for (std::size_t i = 0; i < properties_.size(); ++i) {
        const auto& property = properties_[i];
        if (!property.read || property.floating || property.read->service != service) continue;
        if (const auto* raw = raw_in(*property.read, published))
            changed = (is_contact(property) ? take_contact(property, raws_[i], *raw, how, now)
                                            : take(property, raws_[i], *raw, how, now)) ||
                      changed;
    }
    return changed;
}

bool KnownValues::take_contact(const Property& property, Raw& raw, const json& level, How how, Time now) {
    const auto number = number_of(level);
    if (!number || !has_value(property, level)) return false;
    const bool counts =
        raw.contact.heard(*number, raw.how == How::kNone ? std::nullopt : number_of(raw.value), now);
    const bool changed = counts && count(property, raw, level, how, now);
    look_again(raw.contact);
    return changed;
}

/// The first level that is known is no event: nobody pressed a button then.
bool KnownValues::count(const Property& property, Raw& raw, const json& level, How how, Time now) {
    const bool other = raw.how != How::kNone && raw.value != level;
    const bool changed = take(property, raw, level, how, now);
    if (other && is_button(property))
        raw.contact.changed(value_of(property, level) == json(true), now, next_event_);
    return changed;
}

void KnownValues::look_again(const Contact& contact) {
    const auto next = contact.next_deadline();
    if (next && (!due_ || *next < *due_)) due_ = next;
}

bool KnownValues::tick(Time now) {
    if (!due_ || now < *due_) return false;
    due_.reset();
    bool changed = false;
    for (std::size_t i = 0; i < properties_.size(); ++i) {
        if (!is_contact(properties_[i])) continue;
        auto& raw = raws_[i];
        if (const auto level = raw.contact.settled(now))
            changed = count(properties_[i], raw, json_number(*level), How::kReported, now) || changed;
        changed = raw.contact.tick(now, next_event_) || changed;
        look_again(raw.contact);
    }
    return changed;
}

std::vector<ButtonEvent> KnownValues::events(std::size_t index, Time now) const {
    return is_button(properties_[index]) ? raws_[index].contact.events(now) : std::vector<ButtonEvent>();
}

bool KnownValues::set_by(const Property& property, const Setter& setter, Raw& raw, const json& values,
                         bool perhaps, Time now) const {
    if (setter.element_at &&
        (*setter.element_at >= values.size() || values[*setter.element_at] != json(setter.element)))
        return false;
    // A light of which one part is in doubt is in doubt.
    if (perhaps || (!setter.value_at && !setter.value)) return lose(raw, Unknown::kDoubt, now);
    if (setter.value_at && *setter.value_at >= values.size()) return false;
    const json value = setter.value_at ? values[*setter.value_at] : json_number(*setter.value);
    if (!setter.color) return take(property, raw, value, How::kSet, now);
    const bool changed = raw.color != value || raw.how != How::kSet;
    raw.color = value;
    raw.how = How::kSet;
    raw.since = now;
    return changed;
}

bool KnownValues::executed(std::string_view service, const model::RequestValues& request, bool perhaps,
                           Time now) {
    bool changed = false;
    for (std::size_t i = 0; i < properties_.size(); ++i) {
        const auto& property = properties_[i];
        if (property.service != service) continue;
        // What the board itself shows is not known by what was set.
        if (property.read) continue;
        for (const auto& setter : property.setters)
            if (setter.command == request.command->name)
                changed = set_by(property, setter, raws_[i], request.values, perhaps, now) || changed;
    }
    return changed;
}

bool KnownValues::forget(Time now) {
    pins_.clear();
    bool changed = false;
    for (auto& raw : raws_)
        changed = lose(raw, Unknown::kRestart, now) || changed;
    return changed;
}

void KnownValues::input_begins(std::string_view io, int pin) {
    pins_.erase(level_key(io, pin));
}

bool KnownValues::input_began(std::string_view io, int pin, Time now) {
    if (pins_.contains(level_key(io, pin))) return false;
    return reported(io, json{{"digital", {{std::to_string(pin), 0}}}}, How::kReported, now);
}

json KnownValues::pins(std::string_view io) const {
    auto result = json::object();
    for (const auto* event : kPinEvents) {
        const auto place = std::string(io) + "/" + event + "/";
        for (auto heard = pins_.lower_bound(place); heard != pins_.end() && heard->first.starts_with(place);
             ++heard)
            result[event][heard->first.substr(place.size())] = heard->second.value;
    }
    return result;
}

Known KnownValues::known(std::size_t index) const {
    const auto& property = properties_[index];
    const auto& raw = raws_[index];
    Known known{{}, raw.how, raw.why, raw.since};
    if (raw.how == How::kNone) return known;
    auto value = property.kind == Kind::kLight
                     ? light_of(property, number_of(raw.value), number_of(raw.color))
                     : value_of(property, raw.value);
    if (value)
        known.value = std::move(*value);
    else
        known.how = How::kNone;
    return known;
}

}  // namespace asip::property
