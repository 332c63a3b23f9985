// SPDX-License-Identifier: Apache-2.0
#include "sim/wiring/part_kind.hpp"

#include <algorithm>

namespace asip::sim {

const PartVerb* PartKind::verb(std::string_view wanted) const {
    const auto found = std::find_if(verbs.begin(), verbs.end(),
                                    [&](const PartVerb& candidate) { return candidate.name == wanted; });
    return found == verbs.end() ? nullptr : &*found;
}

const PartKind* PartKind::find(std::string_view name) {
    for (const auto* kind : all())
        if (kind->name == name) return kind;
    return nullptr;
}

}  // namespace asip::sim
