// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "asip/link/cable_frames.hpp"

namespace asip::gateway {

/// The way from one cable to the agent that serves its board.
class CableWay {
  public:
    struct Handlers {
        std::function<void(const link::CableMessage&)> on_message;
        /// It ended by itself; why, for a person. Nothing follows.
        std::function<void(const std::string& why)> on_end;
    };
    virtual ~CableWay() = default;
    virtual void send(link::CableKind kind, std::string_view payload) = 0;
    virtual std::size_t unsent_bytes() const = 0;
};

}  // namespace asip::gateway
