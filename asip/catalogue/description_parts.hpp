// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "asip/catalogue/hash.hpp"
#include "asip/catalogue/kinds.hpp"
#include "asip/model/labels.hpp"

namespace asip::catalogue {

/// A service of a list; the views are into the list's text.
struct Service {
    std::string_view name;
    std::string_view model;  // "distance@1"; empty: none, or carried in full
    std::string_view title;  // raw JSON text between the quotes
    Kind* kind = nullptr;
    std::int32_t count = -1;  // -1: unknown
    std::int32_t period = -1;
    char id = 0;  // 0: unknown
};

// Parts of descriptions that many boards have in common (same sketch, same pins) are kept once. Each holds
// the JSON text as it came and what queries need of it.

struct FirmwarePart {
    std::string text;
    std::uint32_t references = 0;
    std::string chip;
    std::string sketch;
    std::string protocol;
};

struct PinsPart {
    std::string text;
    std::uint32_t references = 0;
    unsigned capabilities = 0;  // what some pin can: 1 digital, 2 analog in, 4 PWM
};

struct ServicesPart {
    std::string text;
    std::uint32_t references = 0;
    std::vector<Service> services;
    std::vector<std::pair<Kind*, std::uint32_t>> kinds;  // each once, with how many services
    // Service index, unit: of models carried in full.
    std::vector<std::pair<std::uint16_t, std::string>> own_units;
};

/// The parts of one type, found by their text. A part lives as long as a board refers to it.
template <class Part>
class PartPool {
  public:
    explicit PartPool(std::uint64_t seed) : parts_(16, Hash{seed}, Equal{}) {}
    ~PartPool() {
        for (Part* part : parts_)
            delete part;
    }
    PartPool(const PartPool&) = delete;
    PartPool& operator=(const PartPool&) = delete;

    Part* find(std::string_view text) const {
        const auto found = parts_.find(text);
        return found == parts_.end() ? nullptr : *found;
    }
    Part* add(std::unique_ptr<Part> part) { return *parts_.insert(part.release()).first; }
    void remove(Part* part) {
        parts_.erase(part);
        delete part;
    }
    std::size_t size() const { return parts_.size(); }

  private:
    struct Hash {
        using is_transparent = void;
        std::uint64_t seed;
        std::size_t operator()(std::string_view text) const { return hash_bytes(text, seed); }
        std::size_t operator()(const Part* part) const { return hash_bytes(part->text, seed); }
    };
    struct Equal {
        using is_transparent = void;
        bool operator()(const Part* a, const Part* b) const { return a->text == b->text; }
        bool operator()(std::string_view a, const Part* b) const { return a == b->text; }
        bool operator()(const Part* a, std::string_view b) const { return a->text == b; }
    };
    std::unordered_set<Part*, Hash, Equal> parts_;
};

/// Each from JSON text that bus::JsonScanner has accepted; null if it is not what the member should hold.
std::unique_ptr<FirmwarePart> read_firmware(std::string_view text);
std::unique_ptr<PinsPart> read_pins(std::string_view text);
/// The kinds in it are referred to; the one that deletes the part releases them.
std::unique_ptr<ServicesPart> read_services(std::string_view text, KindTable& kinds);

/// Labels and friendly names, from the members of these names; empty: there is none. Null if they are not
/// what they should be.
std::unique_ptr<model::Labels> read_labels(std::string_view labels, std::string_view names);

/// What stood between the quotes of a JSON string, escapes undone.
std::string unescape(std::string_view raw);

}  // namespace asip::catalogue
