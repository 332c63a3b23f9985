// SPDX-License-Identifier: Apache-2.0
// The firmware's line reader and request parser by exhaustion: each input of up to N bytes out of an alphabet
// of classes of bytes, and a second of silence anywhere in it, against the judge. States that were seen are
// not tried again. From four starts: a board at rest, one with an extension in use, one with checksums (whose
// last "byte" may be a whole line end, `*HH` as it has to be), and one whose pins are written.
//
// What the bound leaves out:
//   - a longer request. The parser takes a request argument by argument, and each way out of an argument is
//   within
//     nine bytes; the longest lines with each single damage are the next test (every_damage);
//   - of the last byte, those that do not end a request, which are only added to it, as each byte before was;
//   CR and
//     silence, which end it as LF does; and with checksums LF alone;
//   - other bytes than those of the alphabet: `--wide` has more of them for fewer bytes, and
//   fuzz_firmware_lines all.
// With sanitizers it runs with a small bound, as a unit test.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "tests/firmware/bench.hpp"

namespace {

using wire::Bench;

/// Besides bytes: a second of silence, and the line end that checksums ask for.
constexpr int kSilence = 256, kRightEnd = 257;

struct Start {
    const char* name;
    const char* before;  ///< is sent first
    bool inputs;
    std::vector<int> alphabet;
    std::vector<int> wide;
};

// A service, another one, a tag, digit, sign, comma, brace, `?`, `#`, checksum mark, blank, zero, line ends,
// a byte that is no ASCII.
const std::vector<int> kAlphabet{'C', 'E', 'm', '1', '-',  ',',  '{',  '?',
                                 '#', '*', ' ', 0,   '\r', '\n', 0xC3, kSilence};
const std::vector<int> kWide{'C', 'E', 'I', 'V', 'm', 'd',  '0', '1', '3',  '-',  '+',  ',',  '.',     '{',
                             '}', '?', '#', '!', '*', '\t', ' ', 0,   '\r', '\n', 0x7F, 0xC3, kSilence};
const std::vector<int> kPins{'I', 'C', 'd', 'm', '1', '3', '0', '-', ',', '.', ' ', 0, '\r', '\n', kSilence};

std::vector<int> with_right_end(std::vector<int> alphabet) {
    alphabet.back() = kRightEnd;
    return alphabet;
}

const std::vector<Start> kStarts{
    {"rest", "", false, kAlphabet, kWide},
    {"extended", "#,E,t\n", false, kAlphabet, kWide},
    {"checksums", "#,C,1\n", false, with_right_end(kAlphabet), with_right_end(kWide)},
    {"pins", "", true, kPins, kPins},
};

class Explorer {
  public:
    Explorer(Bench& bench, std::vector<int> alphabet) : bench_(bench), alphabet_(std::move(alphabet)) {}

    /// False: something was wrong, and is printed.
    bool explore(unsigned bytes) {
        Bench::State here;
        bench_.save(here);
        // A line that is open is told by its bytes: no other path leads to it.
        if (!bench_.judge().line_is_open()) {
            auto& tried = tried_[std::string(here.as_bytes())];
            if (tried >= bytes) return true;
            tried = bytes;
        }
        bool first = true;
        for (const int symbol : alphabet_) {
            if (!first) bench_.put_back(here);
            if (bytes == 1 && !may_end(symbol)) continue;
            first = false;
            path_.push_back(symbol);
            ++steps_;
            const char* const wrong = step(symbol);
            if (wrong != nullptr) fmt::print("FAILED: {}: {}\n", wrong, told());
            if (wrong != nullptr) return false;
            // Silence that ends no line leaves it as it was.
            const bool as_before = symbol == kSilence && bench_.judge().line_is_open();
            if (bytes > 1 && !as_before && !explore(bytes - 1)) return false;
            path_.pop_back();
        }
        return true;
    }
    std::uint64_t steps() const { return steps_; }

  private:
    bool may_end(int symbol) const {
        const auto& judge = bench_.judge();
        if (symbol == kRightEnd || symbol == '\n') return (symbol == kRightEnd) == judge.uses_checksums();
        return symbol == ',' && judge.may_end_at(',');
    }
    const char* step(int symbol) {
        if (symbol == kSilence) return bench_.second_of_silence();
        if (symbol != kRightEnd) return bench_.byte(static_cast<std::uint8_t>(symbol));
        unsigned sum = 0;
        for (const char c : bench_.judge().text())
            sum ^= static_cast<unsigned char>(c);
        return bench_.bytes(fmt::format("*{:02X}\n", sum));
    }
    std::string told() const {
        std::string text;
        for (const int symbol : path_)
            text += symbol == kSilence              ? "<a second>"
                    : symbol == kRightEnd           ? "*HH\\n"
                    : symbol > ' ' && symbol < 0x7F ? std::string(1, static_cast<char>(symbol))
                                                    : fmt::format("\\x{:02X}", symbol);
        return text;
    }

    Bench& bench_;
    std::vector<int> alphabet_;
    std::vector<int> path_;
    std::unordered_map<std::string, unsigned> tried_;
    std::uint64_t steps_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Tries each short input on the firmware's parser.");
    unsigned bytes = 5;
    std::string only;
    bool wide = false;
    app.add_option("--bytes", bytes, "Of each input")->capture_default_str();
    app.add_option("--start", only, "rest, extended, checksums or pins: this one only");
    app.add_flag("--wide", wide, "More bytes to choose from");
    CLI11_PARSE(app, argc, argv);
    bool good = true;
    unsigned starts = 0;
    for (const auto& start : kStarts) {
        if (!only.empty() && only != start.name) continue;
        ++starts;
        Bench bench(start.inputs);
        if (const char* wrong = bench.bytes(start.before)) {
            fmt::print("FAILED: {}: {}\n", wrong, start.before);
            return 1;
        }
        Explorer explorer(bench, wide ? start.wide : start.alphabet);
        good = explorer.explore(bytes) && good;
        fmt::print("{}: {} bytes, {} steps, {} requests executed\n", start.name, bytes, explorer.steps(),
                   bench.executed());
    }
    return good && starts != 0 ? 0 : 1;
}
