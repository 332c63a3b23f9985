// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "asip/model/model_set.hpp"

namespace asip::model {

/// Markdown for people: models with events, commands, arguments and examples, by name. docs/services.md is
/// that of the standard models.
std::string reference_page(const ModelSet& models);

/// The page of one model alone.
std::string reference_page(const ServiceModel& model);

}  // namespace asip::model
