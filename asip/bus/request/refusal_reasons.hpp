// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace asip::bus {

// What each of these words means to a person is in answer_words.cpp.

/// Reasons of Reply::kRefused that every program knows.
inline constexpr std::string_view kRefusedQueueFull = "queue-full";
inline constexpr std::string_view kRefusedInvalid = "invalid";
inline constexpr std::string_view kRefusedBoardNotThere = "board-not-there";
inline constexpr std::string_view kRefusedRetained = "retained";
inline constexpr std::string_view kRefusedDeadline = "deadline";
/// It waited while the board was stopped.
inline constexpr std::string_view kRefusedStopped = "stopped";
/// There is nothing to renew.
inline constexpr std::string_view kRefusedNotHeld = "not-held";
inline constexpr std::string_view kRefusedIdReused = "id-reused";
/// A program says it of its own command: the access rules of the broker deny the topic.
inline constexpr std::string_view kRefusedDenied = "denied";

/// Reasons of Reply::kTimeout: something on the line to the board was lost or damaged, so that it may or may
/// not have executed the command; and: it executed the command, but the value that was asked for did not
/// come.
inline constexpr std::string_view kTimeoutDoubt = "doubt";
inline constexpr std::string_view kTimeoutNoValue = "no-value";
/// Of a command of several lines some were sent and others were not.
inline constexpr std::string_view kTimeoutPartly = "partly";
/// The board was not there to confirm a stop.
inline constexpr std::string_view kTimeoutBoardNotThere = "board-not-there";
/// A program says it of its own command: not even an agent answered.
inline constexpr std::string_view kTimeoutNoAnswer = "no-answer";
/// The same: its connection was lost before the answer came.
inline constexpr std::string_view kTimeoutConnection = "connection";

}  // namespace asip::bus
