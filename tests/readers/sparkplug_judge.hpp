// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

#include "gateway/export/sparkplug_payload.hpp"

namespace readers {

/// Whether `read`, nothing for a refusal, is what these bytes mean by the encoding of protobuf and the
/// payload of Sparkplug B 3.0: nullptr, or what is wrong. Written from these two, without a look at the
/// gateway's reader. Where they leave a reader the choice, it may refuse, and what it reads is not another
/// value.
const char* judge_sparkplug(std::string_view bytes,
                            const std::optional<asip::gateway::exports::sparkplug::Payload>& read);

}  // namespace readers
