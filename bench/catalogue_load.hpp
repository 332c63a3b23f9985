// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <cstdio>
#include <string>

namespace asip::bench {

/// Boards as a large site has them: a few sketches in common, each with five standard services; name,
/// session, port and agent of their own. The same numbers give the same texts.
class BoardTexts {
  public:
    /// `distinct`: no two boards have a part in common, the worst case for memory.
    /// `services`: the first so many of the five, 1 to 5.
    explicit BoardTexts(bool distinct = false, std::size_t services = 5)
        : distinct_(distinct), services_(services) {}

    static std::string name(std::uint32_t board) {
        char text[32];
        std::snprintf(text, sizeof text, "board-%06u", board);
        return text;
    }

    std::string description(std::uint32_t board, std::uint64_t seq, int lease = 60) const {
        const unsigned sketch = distinct_ ? board : board % 8;
        char text[2048];
        std::snprintf(
            text, sizeof text,
            R"({"board":"board-%06u","session":"%08x","seq":%llu,"lease":%d,)"
            R"("firmware":{"protocol":"0.4","chip":"ATmega328P","sketch":"Sketch%u","extensions":{"E":1,"I":1,"B":1,"C":1}},)"
            R"("link":{"kind":"serial","path":"/dev/ttyACM%u","baud":500000},)"
            R"("agent":{"version":"0.1.0","host":"host%u","client":"asip-agent-host%u-%08x"},)"
            R"("pins":{"capabilities":"00111511155511336666","owners":"@@IIIIIIISDDIIIIIIII","modes":"66111177177111444444","analog":{"14":%u,"15":1,"16":2,"17":3,"18":4,"19":5}},)"
            R"("services":[)",
            board, board * 2654435761u, static_cast<unsigned long long>(seq), lease, sketch, board % 4,
            board / 4, board / 4, board * 40503u, distinct_ ? board : 0);
        std::string description = text;
        for (std::size_t i = 0; i < services_; ++i)
            description += (i > 0 ? "," : "") + service(i, sketch);
        return description + "]}";
    }

  private:
    static std::string service(std::size_t number, unsigned sketch) {
        switch (number) {
            case 0:
                return R"({"name":"io","id":"I","model":"io@1","title":"ASIP core IO"})";
            case 1:
                return R"({"name":"distance","id":"D","model":"distance@1","title":"Distance","count":2,"period":)" +
                       std::to_string(100 + sketch) + "}";
            case 2:
                return R"({"name":"servo","id":"S","model":"servo@1","title":"Servos","count":2})";
            case 3:
                return R"({"name":"bump","id":"B","model":"bump@1","title":"Bump sensors","count":4,"period":50})";
            default:
                return R"({"name":"encoder","id":"E","model":"encoder@1","title":"Encoders","count":2,"period":20})";
        }
    }

    bool distinct_;
    std::size_t services_;
};

}  // namespace asip::bench
