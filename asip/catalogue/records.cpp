// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "asip/catalogue/catalogue_impl.hpp"

namespace asip::catalogue {

Guesses Catalogue::Impl::guesses_for(const Board* b) const {
    Guesses guesses;
    const FirmwarePart* firmware = b != nullptr && b->firmware != nullptr ? b->firmware : last_firmware_;
    const PinsPart* pins = b != nullptr && b->pins != nullptr ? b->pins : last_pins_;
    const ServicesPart* services = b != nullptr && b->services != nullptr ? b->services : last_services_;
    if (firmware != nullptr) guesses.firmware = firmware->text;
    if (pins != nullptr) guesses.pins = pins->text;
    if (services != nullptr) guesses.services = services->text;
    if (b != nullptr) {
        guesses.agent = b->agent();
        guesses.link = b->link();
    }
    return guesses;
}

namespace {

// The part for a member's text: that of the guess it matched, one known already, or a new one.
template <class Part, class Read>
bool part_for(std::string_view text, Part* own, Part* last, PartPool<Part>& pool, const Read& read,
              Part*& result) {
    result = nullptr;
    if (text.empty()) return true;
    if (own != nullptr && text.data() == own->text.data()) {
        result = own;
    } else if (last != nullptr && text.data() == last->text.data()) {
        result = last;
    } else {
        result = pool.find(text);
        if (result == nullptr) {
            auto made = read(text);
            if (!made) return false;
            result = pool.add(std::move(made));
        }
    }
    return true;
}

}  // namespace

bool Catalogue::Impl::resolve_parts(const DescriptionMembers& members, const Board* b,
                                    FirmwarePart*& firmware, PinsPart*& pins, ServicesPart*& services) {
    pins = nullptr;
    services = nullptr;
    const bool good =
        part_for(members.firmware, b != nullptr ? b->firmware : nullptr, last_firmware_, firmwares_,
                 read_firmware, firmware) &&
        part_for(members.pins, b != nullptr ? b->pins : nullptr, last_pins_, pins_, read_pins, pins) &&
        part_for(
            members.services, b != nullptr ? b->services : nullptr, last_services_, services_,
            [this](std::string_view text) { return read_services(text, kinds_); }, services);
    if (!good) drop_unused(firmware, pins, services);
    return good;
}

void Catalogue::Impl::drop_unused(FirmwarePart* firmware, PinsPart* pins, ServicesPart* services) {
    if (firmware != nullptr && firmware->references == 0) {
        if (last_firmware_ == firmware) last_firmware_ = nullptr;
        firmwares_.remove(firmware);
    }
    if (pins != nullptr && pins->references == 0) {
        if (last_pins_ == pins) last_pins_ = nullptr;
        pins_.remove(pins);
    }
    if (services != nullptr && services->references == 0) drop(services);
}

void Catalogue::Impl::drop(ServicesPart* part) {
    if (last_services_ == part) last_services_ = nullptr;
    for (const Service& service : part->services)
        kinds_.release(service.kind);
    services_.remove(part);
}

bool Catalogue::Impl::store(std::uint32_t slot, const DescriptionMembers& members, FirmwarePart* firmware,
                            PinsPart* pins, ServicesPart* services) {
    Board& b = board(slot);
    bool changed = b.firmware != firmware || b.pins != pins || b.services != services || !b.described;
    if (firmware != nullptr) ++firmware->references;
    if (pins != nullptr) ++pins->references;
    FirmwarePart* old_firmware = b.firmware;
    PinsPart* old_pins = b.pins;
    if (old_firmware != nullptr) --old_firmware->references;
    if (old_pins != nullptr) --old_pins->references;
    b.firmware = firmware;
    b.pins = pins;
    drop_unused(old_firmware, old_pins, nullptr);
    last_firmware_ = firmware != nullptr ? firmware : last_firmware_;
    last_pins_ = pins != nullptr ? pins : last_pins_;
    if (b.services != services) set_services(slot, services);
    last_services_ = services;
    if (b.agent() != members.agent || b.link() != members.link || b.extra() != members.extra) {
        changed = true;
        set_labels(b, members);
        std::string own;
        own.reserve(members.agent.size() + members.link.size() + members.extra.size());
        own.append(members.agent).append(members.link).append(members.extra);
        b.own = std::move(own);
        b.agent_bytes = static_cast<std::uint32_t>(members.agent.size());
        b.link_bytes = static_cast<std::uint32_t>(members.link.size());
    }
    b.described = true;
    if (b.uncommon) b.uncommon->service_names.clear();
    return changed;
}

// They were checked when the description came.
void Catalogue::Impl::set_labels(Board& b, const DescriptionMembers& members) {
    auto labels = read_labels(members.labels, members.names);
    if (labels == nullptr || labels->empty()) {
        if (b.uncommon) b.uncommon->labels.reset();
    } else {
        b.uncommon_data().labels = std::move(labels);
    }
}

void Catalogue::Impl::set_services(std::uint32_t slot, ServicesPart* services) {
    Board& b = board(slot);
    index(b, slot, false);
    ServicesPart* old = b.services;
    if (services != nullptr) ++services->references;
    b.services = services;
    index(b, slot, true);
    if (old != nullptr && --old->references == 0) drop(old);
}

void Catalogue::Impl::set_named_services(std::uint32_t slot) {
    std::string text = "[";
    for (const std::string& name : board(slot).uncommon->service_names) {
        text.append(text.size() > 1 ? ",{\"name\":\"" : "{\"name\":\"").append(name).append("\"}");
    }
    text += ']';
    ServicesPart* part = services_.find(text);
    if (part == nullptr) part = services_.add(read_services(text, kinds_));
    set_services(slot, part);
}

// Puts a board into the sets of its kinds in its state, or takes it out.
void Catalogue::Impl::index(Board& b, std::uint32_t slot, bool present) {
    if (b.services == nullptr) return;
    const std::size_t state = index_of(b.effective);
    for (const auto& [kind, count] : b.services->kinds) {
        kinds_.mark_dirty(kind);
        if (present) {
            kind->boards[state].add(slot);
            kind->services[state] += count;
        } else {
            kind->boards[state].remove(slot);
            kind->services[state] -= count;
        }
    }
    stats_.services[state] += present ? b.services->services.size() : 0 - b.services->services.size();
}

void Catalogue::Impl::emit(Events& events, Event::Kind kind, const Board& b, model::BoardState was) {
    const bool of_state = kind == Event::Kind::kAdded || kind == Event::Kind::kState;
    Event event{kind, b.name, 0, b.effective, was, of_state ? b.reason : model::StateReason::kNone};
    if (event.is_change()) event.seq = ++seq_;
    events.push_back(std::move(event));
}

void Catalogue::Impl::listen(Board& b, bool wanted, Events& events) {
    if (b.listening == wanted) return;
    b.listening = wanted;
    emit(events, wanted ? Event::Kind::kListen : Event::Kind::kUnlisten, b);
}

std::uint32_t Catalogue::Impl::slot_of(std::string_view name) const {
    return names_.find(hash(name), [&](std::uint32_t slot) { return board(slot).name == name; });
}

std::uint32_t Catalogue::Impl::make(std::string_view name, Time now) {
    if (names_.size() >= options_.max_boards) return NameTable::kNone;
    std::uint32_t slot = 0;
    if (free_.empty()) {
        slot = slots_++;
        if (slot % kPage == 0) pages_.push_back(std::make_unique<Board[]>(kPage));
    } else {
        slot = free_.back();
        free_.pop_back();
    }
    Board& b = board(slot);
    b.name = name;
    b.in_use = true;
    b.first_seen = b.since = now;
    if (const auto known = remembered(name)) {
        if (known->state == b.effective) b.since = now - known->age;
    }
    b.deadline = now;
    b.lease_seconds = static_cast<std::uint32_t>(
        std::chrono::duration_cast<std::chrono::seconds>(options_.default_lease).count());
    names_.insert(hash(name), slot, [this](std::uint32_t other) { return hash(board(other).name); });
    order_.add(slot);
    all_[index_of(b.effective)].add(slot);
    return slot;
}

// The board leaves the catalogue; its slot may be used again.
void Catalogue::Impl::release(std::uint32_t slot, Events& events) {
    settle();
    Board& b = board(slot);
    listen(b, false, events);
    if (b.conflict() != nullptr) --stats_.conflicts;
    emit(events, Event::Kind::kForgotten, b);
    set_services(slot, nullptr);
    all_[index_of(b.effective)].remove(slot);
    settle();
    order_.erase(slot);
    names_.erase(hash(b.name), slot, [this](std::uint32_t other) { return hash(board(other).name); });
    wheel_.remove(slot);
    if (b.firmware != nullptr) --b.firmware->references;
    if (b.pins != nullptr) --b.pins->references;
    drop_unused(b.firmware, b.pins, nullptr);
    b = Board{};
    free_.push_back(slot);
}

void Catalogue::Impl::settle() {
    if (order_.settled() && kinds_.settled() && all_[0].settled() && all_[1].settled() && all_[2].settled() &&
        all_[3].settled() && all_[4].settled()) {
        return;
    }
    order_.settle([this](std::uint32_t a, std::uint32_t b) { return board(a).name < board(b).name; });
    for (BoardSet& set : all_)
        set.settle(order_);
    kinds_.settle(order_);
}

}  // namespace asip::catalogue
