// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "asip/expected.hpp"
#include "asip/model/labels.hpp"

/// Asking a board's agent to change the board's labels, friendly names and meanings of properties. A request
/// on ROOT/BOARD/in that is a JSON object with the member "labels", "names" or "meanings"; what is `null` is
/// removed, what is not named stays:
///
///     {"labels":{"room":"lab","shelf":null},"names":{"services":{"servo":"left arm"},"pins":{"13":"lamp"}}}
///
/// The answer has all of them as they are then; its proof says that they are on the disk.
namespace asip::bus {

/// Its payload, with its sender's name.
std::string encode(const model::LabelChange& change, const std::string& by);
/// Whether a request of a board is one of these.
bool is_label_request(const nlohmann::json& object);
/// Reads one. Fails with the first fault and its place; unknown members are refused.
Expected<model::LabelChange> read_label_request(const nlohmann::json& object);

/// The proof in the answer.
inline constexpr std::string_view kProofKept = "kept";
/// Reasons of a refusal: the agent cannot write its state; too many requests of this kind wait.
inline constexpr std::string_view kRefusedNotKept = "not-kept";

}  // namespace asip::bus
