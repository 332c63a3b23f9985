// SPDX-License-Identifier: Apache-2.0
// The firmware's line reader and request parser by exhaustion: each input of up to N bytes out of an alphabet
// of classes of bytes, and a second of silence anywhere in it, against the judge. States that were seen are
// not tried again. From four starts: a board at rest, one with an extension in use, one with checksums (whose
// last "byte" may be a whole line end, `*HH` as it has to be), and one whose pins are written.
//
// What the bound leaves out:
//   - a longer request. The parser takes a request argument by argument, and each way out of an argument is
//     within the bound; the longest lines with each single damage are the next test (every_damage);
//   - of the last byte, those that do not end a request, which are only added to it, as each byte before was;
//     CR and silence, which end it as LF does; and with checksums LF alone;
//   - other bytes than those of the alphabet: `--wide` has more of them for fewer bytes, and
//     fuzz_firmware_lines all;
//   - the sum of digests: behind each request, where board and judge agree on the digest, both go on from one
//     value. Before that, the digest of each byte behind each digest is compared.
// With sanitizers it runs with a small bound, as a unit test.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tests/firmware/bench.hpp"
#include "tests/support/explorer.hpp"

namespace {

using wire::Bench, wire::kRightEnd, wire::kSilence;

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
    bool good = Bench::digests_agree();
    if (!good) fmt::print("FAILED: the digest of a byte\n");
    unsigned starts = 0;
    for (const auto& start : kStarts) {
        if (!only.empty() && only != start.name) continue;
        ++starts;
        Bench bench(start.inputs);
        if (const char* wrong = bench.bytes(start.before)) {
            fmt::print("FAILED: {}: {}\n", wrong, start.before);
            return 1;
        }
        wire::Explorer<Bench> explorer(bench, wide ? start.wide : start.alphabet);
        good = explorer.explore(bytes) && good;
        fmt::print("{}: {} bytes, {} steps, {} states, {} requests executed\n", start.name, bytes,
                   explorer.steps(), explorer.states(), bench.executed());
    }
    return good && starts != 0 ? 0 : 1;
}
