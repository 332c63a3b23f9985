// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asip/catalogue/board.hpp"
#include "asip/catalogue/catalogue.hpp"
#include "asip/catalogue/description_parts.hpp"
#include "asip/catalogue/due_wheel.hpp"
#include "asip/catalogue/name_order.hpp"
#include "asip/catalogue/query_plan.hpp"

namespace asip::catalogue {

/// From a hash to the slots of boards whose names have it: eight bytes an entry, linear probing.
class NameTable {
  public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    /// The slot with this hash for which `same(slot)`, or kNone.
    template <class Same>
    std::uint32_t find(std::uint64_t hash, const Same& same) const {
        if (entries_.empty()) return kNone;
        const auto tag = static_cast<std::uint32_t>(hash >> 32);
        for (std::size_t i = hash & mask(); entries_[i].slot != kNone; i = (i + 1) & mask()) {
            if (entries_[i].tag == tag && same(entries_[i].slot)) return entries_[i].slot;
        }
        return kNone;
    }

    /// `hash_of(slot)` is needed when the table grows.
    template <class HashOf>
    void insert(std::uint64_t hash, std::uint32_t slot, const HashOf& hash_of) {
        if ((size_ + 1) * 4 > entries_.size() * 3) grow(hash_of);
        put(hash, slot);
        ++size_;
    }

    template <class HashOf>
    void erase(std::uint64_t hash, std::uint32_t slot, const HashOf& hash_of) {
        std::size_t hole = hash & mask();
        while (entries_[hole].slot != slot)
            hole = (hole + 1) & mask();
        // Entries behind the hole move up into it unless they would leave the run that begins at their own
        // place.
        for (std::size_t i = (hole + 1) & mask(); entries_[i].slot != kNone; i = (i + 1) & mask()) {
            const std::size_t home = hash_of(entries_[i].slot) & mask();
            if (((i - home) & mask()) >= ((i - hole) & mask())) {
                entries_[hole] = entries_[i];
                hole = i;
            }
        }
        entries_[hole] = Entry{};
        --size_;
    }

    std::size_t size() const { return size_; }

  private:
    struct Entry {
        std::uint32_t tag = 0;
        std::uint32_t slot = kNone;
    };

    std::size_t mask() const { return entries_.size() - 1; }

    void put(std::uint64_t hash, std::uint32_t slot) {
        std::size_t i = hash & mask();
        while (entries_[i].slot != kNone)
            i = (i + 1) & mask();
        entries_[i] = {static_cast<std::uint32_t>(hash >> 32), slot};
    }

    template <class HashOf>
    void grow(const HashOf& hash_of) {
        std::vector<Entry> old(entries_.empty() ? 64 : entries_.size() * 2);
        old.swap(entries_);
        for (const Entry& entry : old) {
            if (entry.slot != kNone) put(hash_of(entry.slot), entry.slot);
        }
    }

    std::vector<Entry> entries_;
    std::size_t size_ = 0;
};

class Catalogue::Impl {
  public:
    explicit Impl(Options options);
    ~Impl();

    Applied apply(const Announcement& announcement, Time now);
    std::vector<Event> expire(Time now, std::size_t most);
    void resume(Time now);
    Expected<std::vector<Event>, NotForgotten> forget(std::string_view name, Time now);
    Expected<bus::Answer> find(const bus::Query& query, Instant now, const View* view);
    std::vector<std::string> names(const std::string& pattern, const std::string& after, std::size_t max);
    void settle();

    std::uint32_t slot_of(std::string_view name) const;
    Board& board(std::uint32_t slot) { return pages_[slot / kPage][slot % kPage]; }
    const Board& board(std::uint32_t slot) const { return pages_[slot / kPage][slot % kPage]; }
    bus::BoardItem board_item(const Board& b, Instant now, bool full) const;
    /// `services`: their names. The texts are those of the catalogue.
    bus::BriefBoard brief_board(const Board& b, Instant now, std::string_view services) const;
    bus::ServiceItem service_item(const Board& b, const Service& service) const;

    Options options_;
    KindTable kinds_;
    CatalogueStats stats_;
    NameOrder order_;
    std::array<BoardSet, kStates> all_;
    DueWheel wheel_;
    NameTable names_;
    std::uint64_t seq_ = 0;
    bool suspended_ = false;
    std::uint32_t slots_ = 0;  // ever made

  private:
    friend struct CatalogueCheck;
    static constexpr std::uint32_t kPage = 256;
    using Events = std::vector<Event>;

    // apply.cpp: what a message means
    std::optional<Refusal> description(const Announcement& a, Time now, Events& events);
    std::optional<Refusal> state(const Announcement& a, Time now, Events& events);
    std::optional<Refusal> board_name(const Announcement& a, Time now, Events& events);
    std::optional<Refusal> service_name(const Announcement& a, Time now, Events& events);
    std::optional<Refusal> traffic(const Announcement& a, Time now, Events& events);
    void say(Board& b, const model::SaidState& said, Time since, Time now);
    void take_said_state(Board& b, const DescriptionMembers& members, const Announcement& a, bool new_session,
                         Time now);

    // presence_lease.cpp: how long a board counts as there
    std::uint32_t lease_of(const DescriptionMembers& members) const;
    void renewed_by_description(Board& b, const Announcement& a, bool repeats, Time now, Events& events);
    std::optional<Refusal> renewed_by_names(std::uint32_t slot, bool retained, bool added, Time now,
                                            Events& events);
    void judge(std::uint32_t slot, Time now, Events& events);
    void update_state(std::uint32_t slot, Time now, Events& events, bool added = false);
    Time forgotten_at(Board& b, Time now) const;
    bool alive(const Board& b, Time now) const { return model::is_there(b.reported) && now < b.deadline; }

    // sessions.cpp: which description may replace which
    enum class Verdict { kAccept, kRenew, kRefuse };
    struct Judgement {
        Verdict verdict;
        Refusal refusal = Refusal::kOldSession;
    };
    Judgement judge(Board& b, const DescriptionMembers& members, const Announcement& a, Time now,
                    Events& events);
    Judgement judge_other_session(Board& b, const DescriptionMembers& members, const Announcement& a,
                                  Time now, Events& events);
    /// When a description was published; nothing: the broker does not tell the age of a stored one.
    static std::optional<Time> published(const Announcement& a, std::uint32_t lease_seconds, Time now);
    void holder_spoke(Board& b, Time now, Events& events);
    bool challenge(Board& b, const DescriptionMembers& members, Time now, Events& events);
    void take_over(Board& b, const DescriptionMembers& members);
    void resolve(Board& b, Events& events);

    // records.cpp: parts and indices
    Guesses guesses_for(const Board* b) const;
    bool resolve_parts(const DescriptionMembers& members, const Board* b, FirmwarePart*& firmware,
                       PinsPart*& pins, ServicesPart*& services);
    bool store(std::uint32_t slot, const DescriptionMembers& members, FirmwarePart* firmware, PinsPart* pins,
               ServicesPart* services);
    void drop_unused(FirmwarePart* firmware, PinsPart* pins, ServicesPart* services);
    void set_services(std::uint32_t slot, ServicesPart* services);
    void set_labels(Board& b, const DescriptionMembers& members);
    void set_named_services(std::uint32_t slot);
    template <class Part>
    void assign(Part*& member, Part* part, PartPool<Part>& pool);
    void drop(ServicesPart* part);
    void index(Board& b, std::uint32_t slot, bool present);
    void emit(Events& events, Event::Kind kind, const Board& b,
              model::BoardState was = model::BoardState::kLost);
    void listen(Board& b, bool wanted, Events& events);
    std::uint32_t make(std::string_view name, Time now);
    void release(std::uint32_t slot, Events& events);

    // find.cpp: one page of a query
    struct Page;
    std::optional<std::size_t> total_by_index(const QueryPlan& plan) const;
    void fill_by_name(const QueryPlan& plan, Page& page) const;
    void fill_sorted(const QueryPlan& plan, Page& page) const;
    // candidates.cpp: `visit(slot)` for each board of the plan's kinds and states, in the order of names,
    // from its cursor on, until `visit` returns false
    void visit_candidates(const QueryPlan& plan, const std::function<bool(std::uint32_t slot)>& visit) const;

    std::optional<Remembered> remembered(std::string_view name) const {
        return options_.remembered ? options_.remembered(name) : std::nullopt;
    }
    std::uint64_t hash(std::string_view name) const { return hash_bytes(name, options_.hash_seed); }

    PartPool<FirmwarePart> firmwares_;
    PartPool<PinsPart> pins_;
    PartPool<ServicesPart> services_;
    FirmwarePart* last_firmware_ = nullptr;  // guesses for boards not seen before
    PinsPart* last_pins_ = nullptr;
    ServicesPart* last_services_ = nullptr;
    std::vector<std::unique_ptr<Board[]>> pages_;
    std::vector<std::uint32_t> free_;
    std::vector<std::uint32_t> due_;
    std::uint32_t epoch_ = 1;
};

}  // namespace asip::catalogue
