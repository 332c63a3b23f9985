// SPDX-License-Identifier: Apache-2.0
#include "registry/refusal_log.hpp"

#include "asip/model/description.hpp"

namespace asip::registry {
namespace {

constexpr std::size_t kMaxTopicBytes = 200;
constexpr std::size_t kMaxPayloadBytes = 80;
constexpr std::size_t kMaxSourceBytes = 100;

bool is_worth_a_line(Refusal refusal) {
    switch (refusal) {
        case Refusal::kNotForUs:
        case Refusal::kOldSequence:
        case Refusal::kOldSession:
        case Refusal::kUnproven:
        case Refusal::kConflict:
        case Refusal::kOldHint:
            return false;
        default:
            return true;
    }
}

// The catalogue reads descriptions in one pass and keeps no account of places; this reads one again.
std::string place_of(Refusal refusal, const std::string& payload) {
    if (refusal != Refusal::kMalformed) return {};
    const auto description = model::parse_description(payload);
    return description ? std::string() : description.error();
}

}  // namespace

std::optional<RefusalLog::Line> RefusalLog::refused(const mqtt::Message& message, std::string_view board,
                                                    Refusal refusal) {
    if (!is_worth_a_line(refusal) || logged_.size() >= kMaxLines) return std::nullopt;
    const std::string_view source = board.empty() ? std::string_view(message.topic) : board;
    const std::string reason(to_text(refusal));
    if (!logged_.insert(reason + " " + std::string(source.substr(0, kMaxSourceBytes))).second)
        return std::nullopt;
    return Line{reason, message.topic.substr(0, kMaxTopicBytes), message.payload.substr(0, kMaxPayloadBytes),
                place_of(refusal, message.payload)};
}

}  // namespace asip::registry
