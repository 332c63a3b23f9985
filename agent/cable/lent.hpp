// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace asip::agent {

/// A board that a browser lends, beyond what its port says.
struct Lent {
    std::string vendor, product;  ///< of its USB port; empty: the browser does not say
    std::string why_gone;         ///< why its cable is gone, for a person
    bool pupils = false;          ///< called after its place, whatever name it has stored
};

}  // namespace asip::agent
