#include "asip/session/identity.hpp"

#include <algorithm>

namespace asip::session {

const BoardService* Identity::find_service(char letter) const {
    auto it = std::find_if(services.begin(), services.end(),
                           [&](const BoardService& s) { return s.letter == letter; });
    return it == services.end() ? nullptr : &*it;
}

std::string Identity::version() const {
    return std::to_string(version_major) + "." + std::to_string(version_minor);
}

}  // namespace asip::session
