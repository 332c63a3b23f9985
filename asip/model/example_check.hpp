// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

/// Whether an example of the model is true: its event decodes to its JSON, its command encodes to its line
/// and is understood as that line, or is refused with its reason. Fails with what happens instead.
Expected<void> check_example(const ServiceModel& model, const ModelExample& example);

/// What no example shows, in words for a person: "no example shows the event \"speed\"". Each event and each
/// command needs one, and there must be a command that is refused.
std::vector<std::string> missing_examples(const ServiceModel& model);

}  // namespace asip::model
