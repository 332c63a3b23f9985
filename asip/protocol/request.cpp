// SPDX-License-Identifier: Apache-2.0
#include "asip/protocol/request.hpp"

#include <algorithm>

#include "asip/protocol/body.hpp"
#include "asip/protocol/limits.hpp"

namespace asip::protocol {

std::string make_request(char service, char tag, std::initializer_list<int> parameters) {
    std::string line{service, ',', tag};
    for (const int parameter : parameters) {
        line += ',';
        line += std::to_string(parameter);
    }
    return line;
}

std::string set_pin_mode(int pin, PinMode mode) {
    return make_request('I', 'P', {pin, static_cast<int>(mode)});
}
std::string digital_write(int pin, bool high) {
    return make_request('I', 'd', {pin, high ? 1 : 0});
}
std::string analog_write(int pin, int value) {
    return make_request('I', 'a', {pin, value});
}
std::string echo(std::string_view token) {
    return "#,E," + std::string(token);
}

std::string verified_fence(std::string_view token) {
    return "#,V," + std::string(token);
}
std::string set_line_rate(int baud) {
    return make_request('#', 'B', {baud});
}
std::string set_checksum(bool on) {
    return make_request('#', 'C', {on ? 1 : 0});
}

Expected<Request> parse_request(std::string_view line) {
    if (line.size() > kMaxRequestBytes) {
        return fail("request is " + std::to_string(line.size()) + " bytes long, above " +
                    std::to_string(kMaxRequestBytes));
    }
    const bool printable =
        std::all_of(line.begin(), line.end(), [](char c) { return c >= 0x20 && c <= 0x7e; });
    if (!printable) return fail("request holds bytes that are not printable ASCII");
    const bool addressed = line.size() >= 3 && line[1] == ',' && line[2] != ',' && line[2] != ' ' &&
                           (line[0] == '#' || (line[0] >= 'A' && line[0] <= 'Z'));
    if (!addressed || (line.size() > 3 && line[3] != ','))
        return fail("'" + std::string(line) + "' is not a request: SERVICE,TAG[,PARAMETERS]");
    return Request{line, line[0], line[2], line.size() > 4 ? line.substr(4) : std::string_view{}};
}

std::size_t ignored_before(std::string_view text) {
    const auto first =
        std::find_if(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) > ' '; });
    return static_cast<std::size_t>(first - text.begin());
}

std::string_view significant(std::string_view line) {
    line.remove_prefix(ignored_before(line));
    while (!line.empty() && static_cast<unsigned char>(line.back()) <= ' ')
        line.remove_suffix(1);
    return line.starts_with('!') ? std::string_view{} : line;
}

namespace {

/// Takes the next line off, as significant() gives it.
std::string_view take_line(std::string_view& payload) {
    const auto end = find_any(payload, kRequestEnds);
    const auto line = significant(payload.substr(0, end));
    payload.remove_prefix(end == std::string_view::npos ? payload.size() : end + 1);
    return line;
}

}  // namespace

PayloadLines lines_of(std::string_view payload) {
    PayloadLines lines;
    while (!payload.empty()) {
        const auto line = take_line(payload);
        if (line.empty()) continue;
        if (lines.count++ == 0) lines.first = line;
    }
    return lines;
}

Expected<std::vector<Request>> split_requests(std::string_view payload) {
    if (payload.size() > kMaxPayloadBytes) {
        return fail("payload is " + std::to_string(payload.size()) + " bytes long, above " +
                    std::to_string(kMaxPayloadBytes));
    }
    std::vector<Request> requests;
    while (!payload.empty()) {
        const auto line = take_line(payload);
        if (line.empty()) continue;
        const auto request = parse_request(line);
        if (!request) return fail(request.error());
        if (requests.size() == kMaxRequestsPerPayload)
            return fail("payload holds more than " + std::to_string(kMaxRequestsPerPayload) + " requests");
        requests.push_back(*request);
    }
    if (requests.empty()) return fail("payload holds no request");
    return requests;
}

}  // namespace asip::protocol
