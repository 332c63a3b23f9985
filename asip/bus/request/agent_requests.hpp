// SPDX-License-Identifier: Apache-2.0
/// Asking a board's agent to let go of the board's port, so that another program (avrdude) can use it. A
/// request on ROOT/BOARD/in that is a JSON object with the member "port":
///
///     {"port":"release","seconds":60}   let go of it, and take it back when the time is over; the same again
///                                       by the same `by` prolongs it
///     {"port":"take"}                   take it back now
///     {"port":"load","firmware":"AsipServices"}   load this firmware into the board, and take the port back;
///                                       "board":"mega" says which board it is, "force":true that it may run
///                                       ASIP already
///     {"port":"load","update":true}     load the newer version of the sketch that the board runs; where the
///                                       agent has none, nothing is done
#pragma once
#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "asip/expected.hpp"
#include "asip/model/labels.hpp"

namespace asip::bus {

// Asking a board's agent to change the board's labels, friendly names and meanings of properties: a request
// with the member "labels", "names" or "meanings"; what is `null` is removed, what is not named stays:
//
//     {"labels":{"room":"lab","shelf":null},"names":{"services":{"servo":"left arm"},"pins":{"13":"lamp"}}}
//
// The answer has all of them as they are then; its proof says that they are on the disk.

/// With its sender's name.
std::string encode(const model::LabelChange& change, const std::string& by);
bool is_label_request(const nlohmann::json& object);
/// Fails with the first fault and its place; unknown members are refused.
Expected<model::LabelChange> read_label_request(const nlohmann::json& object);

inline constexpr std::string_view kProofKept = "kept";
/// The agent cannot write its state; too many such requests wait.
inline constexpr std::string_view kRefusedNotKept = "not-kept";

struct PortRequest {
    enum class What { kRelease, kTake, kLoad };
    What what = What::kRelease;
    std::chrono::seconds time{60};  ///< kRelease: kMinTime to kMaxTime
    std::string firmware{};         ///< kLoad: a name, not a path
    std::string board{};            ///< kLoad: as the agent calls kinds of boards; empty: it finds out
    bool force = false;             ///< kLoad: also where the board runs ASIP
    bool update = false;            ///< kLoad: what the board runs, where that is out of date

    static constexpr std::chrono::seconds kMinTime{1};
    static constexpr std::chrono::seconds kMaxTime{3600};
    friend bool operator==(const PortRequest&, const PortRequest&) = default;
};

/// With its sender's name: while the port is released, others are refused.
std::string encode(const PortRequest& request, const std::string& by);
bool is_port_request(const nlohmann::json& object);
/// Fails with the first fault and its place; unknown members are refused.
Expected<PortRequest> read_port_request(const nlohmann::json& object);

/// Another has it; it was not released.
inline constexpr std::string_view kRefusedReleased = "released";
inline constexpr std::string_view kRefusedNotReleased = "not-released";
/// With kLoad: the board runs ASIP already; no boot loader answered.
inline constexpr std::string_view kRefusedSpeaksAsip = "speaks-asip";
inline constexpr std::string_view kRefusedNotLoaded = "not-loaded";

}  // namespace asip::bus
