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

/// What decoding needs to know of the board.
struct DecodeContext {
    const protocol::PortMap* ports = nullptr;       // needed by shape Ports
    std::span<const protocol::PinMode> modes = {};  // where known, digital events name input pins only
};

/// `@D,e,2,{42,118}` -> {"distance":[42,118]}: one object with one member, the event's name. Fails when the
/// model has no event with that tag, or the body does not fit it (values outside min..max pass: a sensor may
/// be out of range).
Expected<nlohmann::json> decode_event(const ServiceModel& model, const protocol::Event& event,
                                      const DecodeContext& context = {});

/// What stands for an event that no model describes: {"tag":"e","body":"2,{42,118}"}.
nlohmann::json raw_event(const protocol::Event& event);

}  // namespace asip::model
