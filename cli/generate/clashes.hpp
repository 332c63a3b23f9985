// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/model/model_set.hpp"

namespace asip::generate {

/// What stands in a model's way beside others, for a person.
struct Clashes {
    std::vector<std::string> faults;  ///< boards or programs would take one for the other
    std::vector<std::string> notes;   ///< worth knowing
};

/// With itself among them it does not clash.
Clashes find_clashes(const model::ServiceModel& model, const model::ModelSet& known);

}  // namespace asip::generate
