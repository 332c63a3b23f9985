// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "asip/catalogue/name_order.hpp"
#include "asip/model/board_state.hpp"
#include "asip/model/labels.hpp"

namespace asip::catalogue {

struct WideProduct {
    std::uint64_t low;
    std::uint64_t high;
    friend bool operator==(const WideProduct&, const WideProduct&) = default;
};

/// For machines without integers of 128 bits.
constexpr WideProduct multiply_by_halves(std::uint64_t a, std::uint64_t b) {
    constexpr std::uint64_t kHalf = 0xFFFFFFFFu;
    const std::uint64_t low = (a & kHalf) * (b & kHalf);
    const std::uint64_t left = (a >> 32) * (b & kHalf) + (low >> 32);
    const std::uint64_t right = (a & kHalf) * (b >> 32) + (left & kHalf);
    return {(right << 32) | (low & kHalf), (a >> 32) * (b >> 32) + (left >> 32) + (right >> 32)};
}

constexpr WideProduct multiply(std::uint64_t a, std::uint64_t b) {
#ifdef __SIZEOF_INT128__
    __extension__ using Wide = unsigned __int128;
    const Wide product = static_cast<Wide>(a) * b;
    return {static_cast<std::uint64_t>(product), static_cast<std::uint64_t>(product >> 64)};
#else
    return multiply_by_halves(a, b);
#endif
}

/// Strangers without the seed cannot choose texts that collide.
inline std::uint64_t hash_bytes(std::string_view text, std::uint64_t seed) {
    const auto mix = [](std::uint64_t a, std::uint64_t b) {
        const auto product = multiply(a, b);
        return product.low ^ product.high;
    };
    std::uint64_t state = seed ^ (text.size() * 0x9E3779B97F4A7C15u);
    const char* at = text.data();
    std::size_t left = text.size();
    while (left >= 16) {
        std::uint64_t a = 0;
        std::uint64_t b = 0;
        std::memcpy(&a, at, 8);
        std::memcpy(&b, at + 8, 8);
        state = mix(a ^ state, b ^ (seed | 1));
        at += 16;
        left -= 16;
    }
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::memcpy(&a, at, left < 8 ? left : 8);
    if (left > 8) std::memcpy(&b, at + 8, left - 8);
    state = mix(a ^ state ^ 0xA0761D6478BD642Fu, b ^ seed ^ 0xE7037ED1A0B428DBu);
    return mix(state, 0x8EBC6AF09C88C6E3u);
}

/// The views are into the list's text.
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
    std::string version, available;
    std::string shown;  // bus::firmware_text()
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

/// The parts of one type, by their text. A part lives as long as a board refers to it.
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

/// Each takes JSON text that bus::JsonScanner accepted; null: it is not what the member should hold.
std::unique_ptr<FirmwarePart> read_firmware(std::string_view text);
std::unique_ptr<PinsPart> read_pins(std::string_view text);
/// It refers to its kinds; whoever deletes the part releases them.
std::unique_ptr<ServicesPart> read_services(std::string_view text, KindTable& kinds);

/// From the members of these names; empty: there is none. Null: they are not what they should be.
std::unique_ptr<model::Labels> read_labels(std::string_view labels, std::string_view names);

/// The content of a JSON string, escapes undone.
std::string unescape(std::string_view raw);

/// The members of a description. The views point into the payload.
struct DescriptionMembers {
    std::string_view board;
    std::string_view session;
    std::uint64_t seq = 0;
    std::uint64_t lease = 0;  // seconds; 0: absent
    std::string_view firmware;
    std::string_view pins;
    std::string_view services;
    std::string_view agent;
    std::string_view link;
    std::string_view labels;
    std::string_view names;
    std::optional<model::SaidState> state;
    std::string extra;  // all others with their keys, as received, joined by commas; labels and names, too
};

/// A member that equals its guess is not parsed again.
struct Guesses {
    std::string_view firmware;
    std::string_view pins;
    std::string_view services;
    std::string_view agent;
    std::string_view link;
};

/// False: no JSON object with board, session, seq and services of the right types, each once. Names are not
/// checked.
bool read_description(std::string_view payload, const Guesses& guesses, DescriptionMembers& members);

}  // namespace asip::catalogue
