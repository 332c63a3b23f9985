// SPDX-License-Identifier: Apache-2.0
// The agent's reader of point-to-point clients by exhaustion: each input of up to N bytes out of an alphabet
// of classes of bytes, and a second of silence anywhere in it, against the judge. Then the longest inputs
// with each single damage, byte by byte and at once: both must come to the same.
//
// What the bound leaves out: other bytes than those of the alphabet, and several damages of one input, which
// fuzz_client_bytes asks the same judge about; of the last byte, those that end no request.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tests/readers/client_bench.hpp"
#include "tests/support/damages.hpp"

namespace {

using readers::ClientBench, readers::Outcome;
using Framing = ClientBench::Framing;

struct Start {
    const char* name;
    Framing framing;
    std::string before;  ///< is sent first
    std::vector<int> alphabet;
    std::vector<std::string> longest;
};

// Two services, one whose requests hold text, tags, a digit, comma, brace, `#`, the mark of debug text,
// blank, zero, line ends, a byte that is no ASCII.
const std::vector<int> kLines{'M', 'I', 'L', 'E', 'm',  '1',  '-',  ',',           '}',
                              '#', '!', ' ', 0,   '\r', '\n', 0xC3, wire::kSilence};
// Lengths up to seven bytes; two bytes of length that are not zero.
const std::vector<int> kFrames{0,   1,   3,   4,   5,   7,    'M',  ',',
                               'm', '1', '#', '!', ' ', '\n', 0xC3, wire::kSilence};

std::string repeated(const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i)
        all += text;
    return all;
}

std::string frame(const std::string& text) {
    return std::string{static_cast<char>(text.size() >> 8), static_cast<char>(text.size() & 0xff)} + text;
}

std::vector<std::string> long_lines() {
    return {repeated("M,m,1,100I,d,13,1", 8) + '\n',
            "L,W,0," + std::string(244, 'x') + '\n',
            "Z,q," + repeated("1,", 122) + "1\r\n",
            "#,E,abcd1234\nM,m,1,100M,m,0,100\n",
            "M,m,1,100#,E,t\nM,m,1,1M,m,0,1\n",
            "!debug M,m,1,1\nD,M\n",
            " \t M,m, 1 , 2 \r\nM,s,1"};
}

std::vector<std::string> long_frames() {
    return {frame("M,m,1,100") + frame("I,d,13,1\n") + frame("#,?"), frame("L,W,0," + std::string(244, 'x')),
            frame(std::string(300, 'M')) + frame("I,d,13,1\r\n"),
            frame("") + frame("!x") + frame(" D,M ") + frame("D,M\nD,M\n\n")};
}

const std::vector<Start> kStarts{
    {"any", Framing::kUnknown, "", kLines, long_lines()},
    {"lines", Framing::kLines, "", kLines, long_lines()},
    {"extended", Framing::kUnknown, "#,E,t\n", kLines, long_lines()},
    {"frames", Framing::kFrames, "", kFrames, long_frames()},
};

std::string some_bytes() {
    return std::string("M1A,#!}- \n\xC3", 11) + '\0';
}

std::string all_bytes() {
    std::string bytes;
    for (int byte = 0; byte < 256; ++byte)
        bytes.push_back(static_cast<char>(byte));
    return bytes;
}

/// What the agent makes of the bytes one by one.
std::vector<Outcome> one_by_one(ClientBench bench, std::string_view bytes) {
    std::vector<Outcome> all;
    for (const char& byte : bytes)
        for (auto& outcome : bench.read({&byte, 1}))
            all.push_back(std::move(outcome));
    return all;
}

/// Those of requests that go to the board: halves may be refused sooner or later than these.
std::vector<Outcome> executed(std::vector<Outcome> all) {
    std::erase_if(all, [](const Outcome& outcome) { return outcome.refused; });
    return all;
}

const char* judged(const ClientBench& start, const std::string& bytes) {
    ClientBench bench = start;
    if (const char* wrong = bench.bytes(bytes)) return wrong;
    if (const char* wrong = bench.step(wire::kSilence)) return wrong;
    ClientBench at_once = start;
    const std::vector<char> exact(bytes.begin(), bytes.end());
    const auto read = at_once.read({exact.data(), exact.size()});
    const auto apart = one_by_one(start, bytes);
    if (read.size() != apart.size() || executed(read) != executed(apart))
        return "it reads something else when all comes at once";
    return nullptr;
}

bool try_damages(const Start& start, const ClientBench& bench, const std::string& bytes, unsigned every,
                 std::uint64_t& tried) {
    bool good = true;
    for (const auto& longest : start.longest)
        good = wire::each_damage(longest, bytes,
                                 [&](const std::string& damaged) {
                                     if (tried++ % every != 0) return true;
                                     const char* const wrong = judged(bench, damaged);
                                     if (wrong)
                                         fmt::print("FAILED: {}: {}, {}\n", wrong, start.name,
                                                    wire::visible(damaged));
                                     return wrong == nullptr;
                                 }) &&
               good;
    return good;
}

/// Published clients send requests without line ends, as many as a read of the agent holds.
bool try_bursts(const ClientBench& bench, int every) {
    for (const std::string request : {"M,m,1,100", "E,A,25", "D,M"})
        for (int times = 1; times < 3000; times += 37 * every) {
            const char* const wrong = judged(bench, repeated(request, times));
            if (wrong) fmt::print("FAILED: {}: {} times {}\n", wrong, times, request);
            if (wrong) return false;
        }
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Tries each short input of a client, and each damage of a long one, on the agent's reader.");
    unsigned bytes = 4, every = 1;
    std::string only;
    bool all = false;
    app.add_option("--bytes", bytes, "Of each input")->capture_default_str();
    app.add_option("--start", only, "any, lines, extended or frames: this one only");
    app.add_flag("--all", all, "Damages by all bytes");
    app.add_option("--every", every, "Each so many of the damages and bursts only")
        ->check(CLI::Range(1, 100));
    CLI11_PARSE(app, argc, argv);
    bool good = true;
    unsigned starts = 0;
    for (const auto& start : kStarts) {
        if (!only.empty() && only != start.name) continue;
        ++starts;
        ClientBench bench(start.framing);
        bench.bytes(start.before);
        std::uint64_t tried = 0;
        good = try_damages(start, bench, all ? all_bytes() : some_bytes(), every, tried) && good;
        if (start.framing == Framing::kLines) good = try_bursts(bench, static_cast<int>(every)) && good;
        wire::Explorer<ClientBench> explorer(bench, start.alphabet);
        good = explorer.explore(bytes) && good;
        fmt::print("{}: {} bytes, {} steps, {} states, {} damaged inputs\n", start.name, bytes,
                   explorer.steps(), explorer.states(), (tried + every - 1) / every);
    }
    return good && starts != 0 ? 0 : 1;
}
