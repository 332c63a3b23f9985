// SPDX-License-Identifier: Apache-2.0
// The gateway's reader of Sparkplug payloads by exhaustion: each input of up to N pieces out of an alphabet,
// as a payload, as the one metric of a payload, and behind each type of a metric, against the judge; each
// input of up to three bytes; and the largest payloads with each single damage. The reader keeps nothing
// between inputs, so there are no states.
//
// What the bound leaves out: several damages of one payload, and longer inputs of other bytes, which
// fuzz_sparkplug asks the same judge about.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "tests/readers/sparkplug_judge.hpp"
#include "tests/support/damages.hpp"

namespace {

using namespace asip::gateway::exports::sparkplug;
using namespace std::string_literals;

// Tags of the fields of payload and metric, one of a group, values, lengths, a byte that goes on, whole
// fields that are long, and varints of ten and eleven bytes.
const std::vector<std::string> kPieces{"\x08"s,
                                       "\x0a"s,
                                       "\x10"s,
                                       "\x12"s,
                                       "\x18"s,
                                       "\x20"s,
                                       "\x2b"s,
                                       "\x38"s,
                                       "\x4a"s,
                                       "\x50"s,
                                       "\x58"s,
                                       "\x70"s,
                                       "\x7a"s,
                                       "\0"s,
                                       "\x01"s,
                                       "\x02"s,
                                       "\x04"s,
                                       "\x7f"s,
                                       "\x80"s,
                                       "\x82\x01"s,
                                       "\x65\0\0\x80\x3f"s,
                                       "\x69\0\0\0\0\0\0\xf0\x3f"s,
                                       std::string(9, '\xff') + "\x01",
                                       std::string(10, '\x80') + "\x01"};

std::uint64_t tried = 0;
unsigned every = 1;

bool is_right(const std::string& bytes) {
    if (tried++ % every != 0) return true;
    // A copy of exactly its size: a sanitizer sees what is read behind it.
    const auto exact = std::make_unique<char[]>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), exact.get());
    const std::string_view input(exact.get(), bytes.size());
    auto read_now = read(input);
    const auto payload = read_now ? std::optional(std::move(*read_now)) : std::nullopt;
    const char* const wrong = readers::judge_sparkplug(input, payload);
    if (wrong) fmt::print("FAILED: {}: {}\n", wrong, wire::visible(bytes));
    return wrong == nullptr;
}

std::string metric(const std::string& bytes) {
    return "\x12"s + static_cast<char>(bytes.size()) + bytes;
}

/// As a payload, and as a metric.
bool both(const std::string& bytes) {
    return is_right(bytes) && is_right(metric(bytes));
}

bool each_of_pieces(std::string& input, unsigned pieces, const std::string& before) {
    const auto size = input.size();
    for (const auto& piece : kPieces) {
        input += piece;
        if (!(before.empty() ? both(input) : is_right(metric(before + input)))) return false;
        if (pieces > 1 && !each_of_pieces(input, pieces - 1, before)) return false;
        input.resize(size);
    }
    return true;
}

bool each_of_bytes(std::string& input, unsigned bytes) {
    for (int byte = 0; byte < 256; ++byte) {
        input.push_back(static_cast<char>(byte));
        if (!both(input)) return false;
        if (bytes > 1 && !each_of_bytes(input, bytes - 1)) return false;
        input.pop_back();
    }
    return true;
}

/// What our gateway writes and hosts send: each type, null, properties, aliases.
std::vector<std::string> payloads() {
    Payload birth{1'700'000'000'000, {}, 0};
    for (std::uint32_t type = 0; type <= static_cast<std::uint32_t>(DataType::kText); ++type)
        birth.metrics.push_back({"m", type, 1, static_cast<DataType>(type), std::int64_t{-1}, {}});
    Payload command{1, {}, 255};
    command.metrics.push_back({"light/on", {}, 2, DataType::kBoolean, true, {}});
    command.metrics.push_back({"", 7, {}, DataType::kDouble, 21.5, {{"engUnit", "C"s}, {"engLow", 0.5}}});
    command.metrics.push_back({"text", {}, {}, DataType::kString, "hello"s, {{"readOnly", false}}});
    command.metrics.push_back({"none", 1, 1, DataType::kInt64, {}, {}});
    return {write(birth), write(command)};
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Tries each short input, and each damage of large ones, on the reader of Sparkplug payloads.");
    unsigned pieces = 3, bytes = 2;
    app.add_option("--pieces", pieces, "Of each input")->capture_default_str();
    app.add_option("--bytes", bytes, "Of inputs of any bytes")->capture_default_str();
    app.add_option("--every", every, "Each so many of all inputs only")->check(CLI::Range(1, 100));
    CLI11_PARSE(app, argc, argv);
    std::string input;
    bool good = is_right("") && each_of_pieces(input, pieces, {}) && each_of_bytes(input, bytes);
    for (char type = 0; good && type <= 16; ++type)
        good = each_of_pieces(input, pieces - 1, "\x20"s + type);
    std::string all;
    for (int byte = 0; byte < 256; ++byte)
        all.push_back(static_cast<char>(byte));
    for (const auto& payload : payloads())
        good = wire::each_damage(payload, all, is_right) && good;
    fmt::print("{} inputs\n", (tried + every - 1) / every);
    return good ? 0 : 1;
}
