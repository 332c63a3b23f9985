// SPDX-License-Identifier: Apache-2.0
// The longest lines of each kind, with each single damage (a byte changed to each other, left out, doubled,
// or one more), on the firmware's parser: the judge says of each what a board may do with it, and the next
// good request is executed. What is left out: two damages of one line, which fuzz_firmware_lines tries.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "FakeHardware.h"
#include "tests/firmware/bench.hpp"
#include "tests/support/damages.hpp"

namespace {

using wire::Bench, wire::visible;

// A line that is damaged may be longer by a byte.
constexpr std::size_t kLongest = wire::Judge::kMaxChecked;

std::string filled(std::string line, char with) {
    line.resize(kLongest, with);
    return line;
}

const std::vector<std::string> kLines{
    "C,m,-32767,65535",
    "C,m, -255.125 , 17.5 ",
    "C,m," + std::string(52, '0') + "12,255",
    filled("C,m,1,1", ' '),
    filled("C,m,1.", '9'),
    filled("E,m,17,A text, with commas, {braces} and C,m,1 ", 'x'),
    filled("E,m,3,", 'C'),
    "I,d,013,255",
    "I,d,2,1",
    "I,P,13,3",
    "#,E,abcd1234",
    "#,V,abcd1234",
    "#,I,A-name.of_thirty-two_characters",
    "#,B,1000000",
    "#,C,1",
    "#,C,0",
    "#,?",
    "Z,q,1,2,3",
    "!" + std::string(70, 'C'),
    filled("C,m,1,1C,m,2,2C,m,3,3E,m,1,text to the end of the line C,m,1", 'y'),
};

/// What has a meaning somewhere, and what has none.
std::string some_bytes() {
    return std::string("CEIVZmd01369-+,.{}?#!*\t \r\n\x7F\xC3", 28) + '\0' + '\xFF';
}

std::string all_bytes() {
    std::string bytes;
    for (int byte = 0; byte < 256; ++byte)
        bytes.push_back(static_cast<char>(byte));
    return bytes;
}

std::string with_end(const std::string& line, bool checksum) {
    unsigned sum = 0;
    for (const char c : line)
        sum ^= static_cast<unsigned char>(c);
    return checksum ? fmt::format("{}*{:02X}\n", line, sum) : line + '\n';
}

/// What is wrong after this line and a good one behind it.
const char* judged(Bench& bench, const std::string& bytes) {
    if (const char* wrong = bench.bytes(bytes)) return wrong;
    // The line end of the damaged line may be gone.
    if (const char* wrong = bench.bytes("\n")) return wrong;
    const auto before = bench.executed();
    if (const char* wrong = bench.bytes(with_end("C,m,1,2", bench.judge().uses_checksums()))) return wrong;
    return bench.executed() == before + 1 ? nullptr : "the next request is not executed";
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Tries each single damage of the longest lines on the firmware's parser.");
    bool some = false;
    app.add_flag("--some", some, "Fewer bytes that come into a line");
    CLI11_PARSE(app, argc, argv);
    const auto bytes = some ? some_bytes() : all_bytes();
    unsigned failures = 0;
    std::uint64_t tried = 0;
    for (const char* before : {"", "#,E,t\n", "#,C,1\n"}) {
        Bench bench(true);
        bench.bytes(before);
        Bench::State start;
        bench.save(start);
        const auto hardware = asip::hw::fake;
        for (auto line : kLines) {
            const bool is_filled = line.size() == kLongest && !bench.judge().uses_checksums();
            if (is_filled) line.resize(wire::Judge::kMaxRequest, line.back());
            const auto whole = with_end(line, bench.judge().uses_checksums());
            const auto good = wire::each_damage(whole, bytes, [&](const std::string& damaged) {
                ++tried;
                const char* const wrong = judged(bench, damaged);
                if (wrong) fmt::print("FAILED: {}: {}{}\n", wrong, visible(before), visible(damaged));
                bench.put_back(start);
                asip::hw::fake = hardware;
                return wrong == nullptr;
            });
            failures += !good;
        }
    }
    fmt::print("{} damaged lines, {} wrong\n", tried, failures);
    return failures == 0 ? 0 : 1;
}
