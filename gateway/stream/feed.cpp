// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/feed.hpp"

namespace asip::gateway {

void append_sse(std::string& out, const StreamEvent& event) {
    if (!event.place.empty()) out.append("id: ").append(event.place).append("\n");
    out.append("event: ").append(event.kind).append("\ndata: ").append(event.data).append("\n\n");
}

std::string websocket_message(const StreamEvent& event, std::string_view ref_json) {
    constexpr std::size_t kAround = 64;
    std::string out;
    out.reserve(kAround + ref_json.size() + event.place.size() + event.data.size());
    out.append("{\"ref\":").append(ref_json).append(",\"event\":\"").append(event.kind).append("\"");
    if (!event.place.empty()) out.append(",\"place\":\"").append(event.place).append("\"");
    if (event.data.size() > 2)
        out.append(",").append(event.data, 1);
    else
        out.append("}");
    return out;
}

}  // namespace asip::gateway
