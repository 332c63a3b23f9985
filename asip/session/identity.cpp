// SPDX-License-Identifier: Apache-2.0
#include "asip/session/identity.hpp"

#include <algorithm>

namespace asip::session {

const protocol::ServiceName* Identity::find_service(char letter) const {
    auto it = std::find_if(services.begin(), services.end(), [&](const auto& s) { return s.id == letter; });
    return it == services.end() ? nullptr : &*it;
}

bool same_board(const Identity& a, const Identity& b) {
    return a.info.major == b.info.major && a.info.minor == b.info.minor && a.info.chip == b.info.chip &&
           a.info.pins == b.info.pins && a.info.sketch == b.info.sketch && a.stored_name == b.stored_name &&
           a.services == b.services && a.extensions == b.extensions && a.pin_owners == b.pin_owners;
}

bool is_other_board(const Identity& a, const Identity& b) {
    return a.info.chip != b.info.chip || a.info.sketch != b.info.sketch || a.stored_name != b.stored_name;
}

}  // namespace asip::session
