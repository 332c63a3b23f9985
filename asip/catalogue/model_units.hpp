// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/catalogue/kinds.hpp"

namespace asip::catalogue {

/// The units of standard models and those in `folder` (empty: none), for queries by unit: of the fields of
/// events and of the arguments of commands. Throws std::runtime_error where a model in the folder is wrong.
UnitsOf units_of_models(const std::string& folder);

}  // namespace asip::catalogue
