// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>

#include "asip/catalogue/catalogue.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::catalogue {

using namespace std::chrono_literals;

inline Time at(Duration since_start) {
    return Time{} + 1h + since_start;
}
inline Instant instant(Time time) {
    return {time, text::WallTime(std::chrono::milliseconds(1'700'000'000'000))};
}

/// A message that owns its texts.
struct OwnedMessage {
    bus::TopicKind kind;
    std::string board;
    std::string payload;
    bool retained = false;
    std::optional<std::uint32_t> expiry_seconds = std::nullopt;

    Announcement view() const { return {kind, board, payload, retained, expiry_seconds}; }
};

inline const std::string kTwoServices =
    R"([{"name":"distance","id":"D","model":"distance@1","title":"Distance","count":2,"period":100},)"
    R"({"name":"servo","id":"S","model":"servo@1","title":"Servos"}])";

struct DescriptionText {
    std::string session = "5f3a9c01";
    std::uint64_t seq = 1;
    std::string services = kTwoServices;
    int lease = 60;
    std::string chip = "ATmega328P";
    std::string capabilities = "00111555";
    std::string more{};  ///< further members
};

inline OwnedMessage description(const std::string& board, const DescriptionText& text = {}) {
    return {
        bus::TopicKind::kDescription, board,
        R"({"board":")" + board + R"(","session":")" + text.session + R"(","seq":)" +
            std::to_string(text.seq) + R"(,"lease":)" + std::to_string(text.lease) +
            R"(,"firmware":{"protocol":"0.4","chip":")" + text.chip +
            R"(","sketch":"AsipHello"},"link":{"kind":"serial","path":"/dev/ttyACM0"},"agent":{"host":"pi","client":"asip-agent-1"},)" +
            R"("pins":{"capabilities":")" + text.capabilities + R"("},"services":)" + text.services +
            (text.more.empty() ? "" : "," + text.more) + "}"};
}

inline OwnedMessage state(const std::string& board, const std::string& word) {
    return {bus::TopicKind::kState, board, word};
}
inline OwnedMessage board_name(const std::string& name) {
    return {bus::TopicKind::kBoardNames, "", name};
}
inline OwnedMessage service_name(const std::string& board, const std::string& name) {
    return {bus::TopicKind::kServiceNames, board, name};
}
inline OwnedMessage traffic(const std::string& board) {
    return {bus::TopicKind::kBoardOut, board, "@D,e,1,{42}"};
}
inline OwnedMessage retained(OwnedMessage message, std::optional<std::uint32_t> expiry = std::nullopt) {
    message.retained = true;
    message.expiry_seconds = expiry;
    return message;
}

}  // namespace asip::catalogue
