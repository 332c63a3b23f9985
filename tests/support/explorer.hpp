// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace wire {

/// Symbols besides bytes: a second of silence, and the line end that checksums ask for (`*HH` and LF).
inline constexpr int kSilence = 256, kRightEnd = 257;

/// Tries each input of up to so many symbols of an alphabet on a bench, which is a reader of bytes with a
/// judge beside it. A bench has:
///   State                 all that decides what comes next, with == and hash()
///   save(), put_back()    of a State
///   line_is_open()        what came since the last request ended is known byte by byte
///   ends_at(symbol)       it is tried as the last symbol: a request may end at it
///   step(symbol)          nullptr, or what is wrong with what the reader did
template <class Bench>
class Explorer {
  public:
    Explorer(Bench& bench, std::vector<int> alphabet) : bench_(bench), alphabet_(std::move(alphabet)) {}

    /// False: something was wrong, and is printed.
    bool explore(unsigned symbols) {
        if (symbols == 1) return try_ends();
        typename Bench::State here;
        bench_.save(here);
        // A line that is open is told by its bytes: no other path leads to it.
        if (!bench_.line_is_open() && was_tried(here, symbols)) return true;
        bool first = true;
        for (const int symbol : alphabet_) {
            if (!std::exchange(first, false)) bench_.put_back(here);
            if (!step(symbol)) return false;
            // Silence that ends no line leaves it as it was.
            const bool as_before = symbol == kSilence && bench_.line_is_open();
            if (!as_before && !explore(symbols - 1)) return false;
            path_.pop_back();
        }
        return true;
    }
    std::uint64_t steps() const { return steps_; }
    std::uint64_t states() const { return states_; }

  private:
    bool try_ends() {
        ends_.clear();
        for (const int symbol : alphabet_)
            if (bench_.ends_at(symbol)) ends_.push_back(symbol);
        typename Bench::State here;
        if (ends_.size() > 1) bench_.save(here);
        for (std::size_t i = 0; i < ends_.size(); ++i) {
            if (i > 0) bench_.put_back(here);
            if (!step(ends_[i])) return false;
            path_.pop_back();
        }
        return true;
    }
    bool step(int symbol) {
        path_.push_back(symbol);
        ++steps_;
        const char* const wrong = bench_.step(symbol);
        if (wrong != nullptr) std::printf("FAILED: %s: %s\n", wrong, told().c_str());
        return wrong == nullptr;
    }
    bool was_tried(const typename Bench::State& here, unsigned symbols) {
        auto& alike = tried_[here.hash()];
        for (auto& [state, tried] : alike) {
            if (!(state == here)) continue;
            if (tried >= symbols) return true;
            tried = symbols;
            return false;
        }
        ++states_;
        alike.emplace_back(here, symbols);
        return false;
    }
    std::string told() const {
        std::string text;
        for (const int symbol : path_) {
            char byte[] = "\\x00";
            std::snprintf(byte, sizeof byte, "\\x%02X", static_cast<unsigned>(symbol & 0xFF));
            text += symbol == kSilence              ? "<a second>"
                    : symbol == kRightEnd           ? "*HH\\n"
                    : symbol > ' ' && symbol < 0x7F ? std::string(1, static_cast<char>(symbol))
                                                    : byte;
        }
        return text;
    }

    Bench& bench_;
    std::vector<int> alphabet_;
    std::vector<int> path_;
    std::vector<int> ends_;
    std::unordered_map<std::size_t, std::vector<std::pair<typename Bench::State, unsigned>>> tried_;
    std::uint64_t steps_ = 0, states_ = 0;
};

}  // namespace wire
