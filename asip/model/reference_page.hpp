// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/model/model_set.hpp"

namespace asip::model {

/// A page in Markdown for people: each model with its events, commands, arguments and examples, in the order
/// of their names. docs/services.md is this page of the standard models.
std::string reference_page(const ModelSet& models);

/// The page of one model alone.
std::string reference_page(const ServiceModel& model);

}  // namespace asip::model
