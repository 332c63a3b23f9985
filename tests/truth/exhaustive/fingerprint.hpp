// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace truth {

/// A number for what it was fed with: by 64 bits, of which some hundred million are told apart.
class Fingerprint {
  public:
    template <class T>
        requires std::is_integral_v<T> || std::is_enum_v<T>
    void add(T value) {
        mix(static_cast<std::uint64_t>(value));
    }
    void add(std::string_view text) {
        add_bytes(text.data(), text.size());
        mix(text.size());
    }
    void add_bytes(const void* from, std::size_t size) {
        const auto* bytes = static_cast<const char*>(from);
        for (; size >= 8; size -= 8, bytes += 8) {
            std::uint64_t word;
            std::memcpy(&word, bytes, 8);
            mix(word);
        }
        std::uint64_t rest = 0;
        std::memcpy(&rest, bytes, size);
        mix(rest);
    }
    std::uint64_t value() const {
        std::uint64_t end = a_ ^ (b_ * 0x9fb21c651e98df25);
        end ^= end >> 32;
        end *= 0xd6e8feb86659fd93;
        return end ^ end >> 32;
    }

  private:
    // Two sums that mix each word in another way: equal ones in both are no accident.
    void mix(std::uint64_t word) {
        a_ = (a_ ^ word) * 0x9e3779b97f4a7c15;
        a_ ^= a_ >> 29;
        b_ = (b_ << 23 | b_ >> 41) * 0xa0761d6478bd642f + word;
    }

    std::uint64_t a_ = 0x243f6a8885a308d3;
    std::uint64_t b_ = 0x13198a2e03707344;
};

}  // namespace truth
