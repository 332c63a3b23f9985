// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "registry/values/recorder.hpp"

namespace asip::registry {

/// Changes as bytes: of each the milliseconds since the one before, in seven bits a byte, and its value in
/// four or eight. Times are those since `begin`.
std::string pack_changes(std::span<const Change> changes, Tick begin);

/// Calls `visit(Change)` for each. What is no such block ends at its fault.
template <class Visit>
void unpack_changes(std::string_view block, Tick begin, const Visit& visit);

// --- details

/// The next change; false: there is none.
bool unpack_change(std::string_view& block, Tick& at, double& value);

template <class Visit>
void unpack_changes(std::string_view block, Tick begin, const Visit& visit) {
    for (Change change{begin, 0}; unpack_change(block, change.at, change.value);)
        visit(change);
}

}  // namespace asip::registry
