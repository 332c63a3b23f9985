// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"
#include "asip/protocol/message.hpp"
#include "asip/protocol/pin.hpp"
#include "asip/protocol/port_map.hpp"

namespace asip::model {

/// What decoding needs of the board; the caller's, for the duration of a call.
struct DecodeContext {
    /// EventShape::kPorts needs it.
    const protocol::PortMap* ports = nullptr;
    /// Where known, digital events name input pins only.
    std::span<const protocol::PinMode> modes = {};
};

/// `@D,e,2,{42,118}` -> {"distance":[42,118]}, with the event's name. Fails where the model has no event with
/// that tag, or a count, a number of fields or a value does not fit. A sensor may be outside min..max; an
/// empty value, `nan`, `inf`, and numbers from 1e15 on are null.
Expected<nlohmann::json> decode_event(const ServiceModel& model, const protocol::Event& event,
                                      const DecodeContext& context = {});

/// For an event without a model: {"tag":"e","body":"2,{42,118}"}.
nlohmann::json raw_event(const protocol::Event& event);

}  // namespace asip::model
