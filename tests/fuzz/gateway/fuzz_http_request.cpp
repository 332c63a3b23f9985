// SPDX-License-Identifier: Apache-2.0
// Bytes of a connection: requests are the same whatever pieces they come in, keep their limits, and name no
// path that could leave a folder.
#include <cstdint>
#include <string>
#include <vector>

#include "gateway/http/request_reader.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace asip::gateway::http;

constexpr RequestReader::Limits kLimits{.header_bytes = 1024, .body_bytes = 256};
constexpr std::size_t kMaxRequests = 16;

struct Outcome {
    std::vector<std::string> requests;
    int status = 0;  // of the error that ended it
    friend bool operator==(const Outcome&, const Outcome&) = default;
};

std::string shown(const Request& request) {
    std::string text = request.method + " " + request.target + "\n";
    for (const auto& [name, value] : request.headers)
        text += name + ": " + value + "\n";
    return text + "\n" + request.body;
}

void check(const Request& request) {
    REQUIRE(request.body.size() <= kLimits.body_bytes);
    for (const auto& segment : request.segments) {
        REQUIRE(segment != "." && segment != "..");
        REQUIRE(segment.find('/') == std::string::npos && segment.find('\0') == std::string::npos);
    }
    accepts_gzip(request);
}

// As a connection does, `step` bytes at a time.
Outcome read(const std::string& bytes, std::size_t step) {
    Outcome outcome;
    RequestReader reader(kLimits);
    std::string held;
    for (std::size_t at = 0; at < bytes.size(); at += step) {
        held.append(bytes, at, step);
        while (!held.empty()) {
            const auto used = reader.feed(held);
            REQUIRE(used <= held.size());
            held.erase(0, used);
            if (reader.error()) {
                outcome.status = reader.error()->status;
                return outcome;
            }
            if (reader.done()) {
                const auto request = reader.take();
                check(request);
                outcome.requests.push_back(shown(request));
                if (outcome.requests.size() == kMaxRequests) return outcome;
                reader = RequestReader(kLimits);
            } else if (used == 0) {
                break;
            }
        }
        if (held.size() > kLimits.header_bytes + kLimits.body_bytes) return outcome;
    }
    return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    const auto whole = read(bytes, std::max<std::size_t>(size, 1));
    const auto single = read(bytes, 1);
    // What is refused for its length may be noticed earlier in smaller pieces, never a different request.
    const auto common = std::min(whole.requests.size(), single.requests.size());
    for (std::size_t i = 0; i < common; ++i)
        REQUIRE(whole.requests[i] == single.requests[i]);
    return 0;
}
