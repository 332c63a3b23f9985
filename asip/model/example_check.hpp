// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

/// The event of an example decodes to its JSON, the command encodes to its line and back, or is refused with
/// its reason. Fails with what happens instead.
Expected<void> check_example(const ServiceModel& model, const ModelExample& example);

/// For a person: "no example shows the event \"speed\"". Each event and command needs one, and one must be
/// refused.
std::vector<std::string> missing_examples(const ServiceModel& model);

}  // namespace asip::model
