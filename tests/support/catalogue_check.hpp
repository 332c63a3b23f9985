// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/catalogue/catalogue.hpp"

namespace asip::catalogue {

struct CatalogueCheck {
    /// First fault found when everything is checked against everything else; empty if there is none. Slow.
    static std::string check(const Catalogue& catalogue);
    /// Everything that does not depend on time, sorted: two catalogues hold the same if these texts are
    /// equal.
    static std::string fingerprint(const Catalogue& catalogue);
};

}  // namespace asip::catalogue
