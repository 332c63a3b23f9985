// SPDX-License-Identifier: Apache-2.0
#include "asip/property/contact.hpp"

#include <algorithm>
#include <utility>

namespace asip::property {
namespace {

constexpr std::pair<ButtonAct, std::string_view> kActs[] = {{ButtonAct::kPress, "press"},
                                                            {ButtonAct::kRelease, "release"},
                                                            {ButtonAct::kHold, "hold"},
                                                            {ButtonAct::kDouble, "double"}};

}  // namespace

std::string_view to_text(ButtonAct act) {
    for (const auto& [each, word] : kActs)
        if (each == act) return word;
    return {};
}

std::vector<std::string_view> button_words() {
    std::vector<std::string_view> words;
    for (const auto& each : kActs)
        words.push_back(each.second);
    return words;
}

std::optional<ButtonAct> button_act(std::string_view word) {
    for (const auto& [act, each] : kActs)
        if (each == word) return act;
    return std::nullopt;
}

bool is_button(const Property& property) {
    return property.kind == Kind::kBinarySensor && property.meaning.klass == "button";
}

bool is_contact(const Property& property) {
    return is_button(property) || (property.kind == Kind::kBinarySensor && property.meaning.klass == "door");
}

bool is_reported(const Property& property) {
    return property.read && !property.read->sum && !property.floating && !is_contact(property);
}

bool Contact::heard(double level, std::optional<double> known, Time now) {
    if (known && now < quiet_at_) {
        if (level != last_.value_or(*known)) quiet_at_ = now + kQuiet;
        last_ = level;
        return false;
    }
    if (known && *known != level) quiet_at_ = now + kQuiet;
    last_.reset();
    return true;
}

std::optional<double> Contact::settled(Time now) {
    if (!last_ || now < quiet_at_) return std::nullopt;
    return std::exchange(last_, std::nullopt);
}

void Contact::changed(bool pressed, Time now, std::uint64_t& next) {
    tell(pressed ? ButtonAct::kPress : ButtonAct::kRelease, now, next);
    hold_at_.reset();
    if (!pressed) return;
    hold_at_ = now + kHold;
    const bool twice = pressed_at_ && now - *pressed_at_ <= kDouble;
    pressed_at_ = now;
    if (!twice) return;
    tell(ButtonAct::kDouble, now, next);
    pressed_at_.reset();  // a third press begins anew
}

bool Contact::tick(Time now, std::uint64_t& next) {
    if (!hold_at_ || now < *hold_at_) return false;
    hold_at_.reset();
    tell(ButtonAct::kHold, now, next);
    return true;
}

std::optional<Time> Contact::next_deadline() const {
    if (last_ && hold_at_) return std::min(quiet_at_, *hold_at_);
    return last_ ? std::optional(quiet_at_) : hold_at_;
}

void Contact::tell(ButtonAct act, Time now, std::uint64_t& next) {
    std::erase_if(told_, [now](const Told& each) { return now - each.when > kRecent; });
    if (told_.size() >= kMaxTold) told_.erase(told_.begin());
    told_.push_back({{next++, act}, now});
}

std::vector<ButtonEvent> Contact::events(Time now) const {
    std::vector<ButtonEvent> result;
    for (const auto& [event, when] : told_)
        if (now - when <= kRecent) result.push_back(event);
    return result;
}

}  // namespace asip::property
