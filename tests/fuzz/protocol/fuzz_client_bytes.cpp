// SPDX-License-Identifier: Apache-2.0
// Bytes as a client might send them, in one control payload or over TCP (lines or frames). There the judge
// of tests/readers says whether the agent made of them what it should, on what its exhaustion leaves out:
// longer inputs, other bytes, several damages. 0xFF is a second of silence.
#include <cstdint>
#include <cstdio>

#include "asip/protocol/request.hpp"
#include "asip/protocol/utf_frame.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/readers/client_bench.hpp"

namespace {

using namespace asip::protocol;

void read_payload(std::string_view payload) {
    const auto requests = split_requests(payload);
    if (!requests) {
        REQUIRE(!requests.error().empty());
        return;
    }
    REQUIRE(!requests->empty() && requests->size() <= kMaxRequestsPerPayload);
    for (const auto& request : *requests) {
        const auto line = request.line;
        REQUIRE(parse_request(line).has_value() && line.size() <= kMaxRequestBytes);
        const auto frame = encode_utf_frame(line);
        REQUIRE(frame.has_value());
        UtfFrameReader reader;
        std::string back;
        reader.push(*frame, [&](std::string_view text) { back = text; });
        REQUIRE(back == line);
    }
}

void read_stream(std::string_view bytes) {
    constexpr char kSilence = '\xFF';
    readers::ClientBench bench(readers::ClientBench::Framing::kUnknown);
    for (const char byte : bytes) {
        const int symbol = byte == kSilence ? wire::kSilence : static_cast<unsigned char>(byte);
        const char* const wrong = bench.step(symbol);
        if (wrong) std::fprintf(stderr, "%s\n", wrong);
        REQUIRE(wrong == nullptr);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    read_payload(bytes);
    read_stream(bytes);
    UtfFrameReader whole(100);
    UtfFrameReader pieces(100);
    std::string from_whole, from_pieces;
    whole.push(bytes, [&](std::string_view frame) {
        REQUIRE(frame.size() <= 100);
        from_whole.append(frame).append("|");
    });
    for (const char& byte : bytes)
        pieces.push({&byte, 1}, [&](std::string_view frame) { from_pieces.append(frame).append("|"); });
    REQUIRE(from_whole == from_pieces);
    return 0;
}
