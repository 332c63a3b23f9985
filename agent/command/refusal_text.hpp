// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/session/action.hpp"
#include "asip/session/board_session.hpp"

namespace asip::agent {

/// Why a request was not queued, and what to do about it, for people. Programs get session::to_string().
std::string refusal_text(session::Refusal refusal);

/// Why a queued request was not sent: a word of `asip/bus/request/reply.hpp`.
std::string_view reason_of(const session::Finished& end);
std::string not_sent_text(const session::Finished& end);

}  // namespace asip::agent
