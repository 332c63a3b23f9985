// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/model/object_text.hpp"

namespace asip::gateway::exports {

using model::ObjectText;

/// A text for a document of so many properties, which seldom has to grow.
inline std::string room_for(std::size_t properties) {
    constexpr std::size_t kUsualBytes = 512, kUsualBytesOfEntity = 256;
    std::string text;
    text.reserve(kUsualBytes + properties * kUsualBytesOfEntity);
    return text;
}

}  // namespace asip::gateway::exports
