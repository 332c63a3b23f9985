// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"
#include "asip/protocol/message.hpp"
#include "asip/protocol/pin.hpp"
#include "asip/protocol/port_map.hpp"

namespace asip::model {

/// What decoding needs to know of the board. Refers to data of the caller, for the duration of a call.
struct DecodeContext {
    /// Needed for events of EventShape::kPorts; they fail without it.
    const protocol::PortMap* ports = nullptr;
    /// The mode of each pin, where known: then digital events name input pins only.
    std::span<const protocol::PinMode> modes = {};
};

/// `@D,e,2,{42,118}` -> {"distance":[42,118]}: one object with one member, the event's name. Fails when the
/// model has no event with that tag, or the body does not fit it: a count, a number of fields or a value that
/// is no number. Values outside min..max pass, as a sensor may be out of its range; an empty one, `nan`,
/// `inf`, and numbers of 1e15 and more are null.
Expected<nlohmann::json> decode_event(const ServiceModel& model, const protocol::Event& event,
                                      const DecodeContext& context = {});

/// What is published for an event that no model describes:
/// {"tag":"e","body":"2,{42,118}"}.
nlohmann::json raw_event(const protocol::Event& event);

}  // namespace asip::model
