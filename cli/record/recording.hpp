// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "asip/bus/topics.hpp"
#include "asip/expected.hpp"
#include "asip/mqtt/message.hpp"
#include "asip/text/wall_time.hpp"

/// A recording: what boards reported and were asked, one JSON object a line. The first line says when it
/// began; each other one is a message:
///
///     {"asip":"recording","version":1,"began":"2026-11-21T10:00:00.000Z"}
///     {"at":0.000312,"what":"description","board":"desk","retained":true,"data":{"board":"desk",...}}
///     {"at":1.204113,"what":"value","board":"desk","service":"distance","data":{"distance":[42]}}
///     {"at":1.204150,"what":"line","board":"desk","text":"@D,e,1,{42}"}
///
/// A payload that is JSON stands in `data`, other text in `text`, other bytes in `hex`.
namespace asip::cli {

/// One message of a recording.
struct RecordedMessage {
    std::chrono::microseconds at{};  ///< since the recording began
    bus::TopicKind kind = bus::TopicKind::kServiceOut;
    std::string board;
    std::string service;  ///< empty: of the whole board
    std::string payload;
    bool retained = false;
};

/// The first line of a recording, with its end.
std::string recording_header(text::WallTime began);
/// When a recording began. Fails where the line is not the first one of a recording, or of a later version.
Expected<text::WallTime> parse_recording_header(std::string_view line);

/// Whether messages on topics of this kind are recorded: all of boards, none of registries.
bool is_recorded(bus::TopicKind kind);
/// The line of a message, with its end. `topic` must be one that is recorded.
void append_recorded(std::string& text, const bus::TopicRef& topic, const mqtt::Message& message,
                     std::chrono::microseconds at);
/// Reads what append_recorded() wrote. Nothing for a line that stands for no message (a gap). Fails with what
/// is wrong.
Expected<std::optional<RecordedMessage>> parse_recorded(std::string_view line);

/// The topic of a message on a bus, for the board under this name.
std::string topic_of(const bus::Topics& topics, const RecordedMessage& message, const std::string& board);

/// Says in a recording that messages may be missing here.
std::string gap_line(std::chrono::microseconds at, std::string_view why);

}  // namespace asip::cli
