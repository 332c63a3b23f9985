// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string_view>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

/// A request as its model reads it.
struct RequestValues {
    const CommandModel* command = nullptr;  ///< of the model
    /// The value of each of given_arguments(), in order: numbers (a color is one, too), texts, and for a list
    /// an array of its items. An item with several fields is an array.
    nlohmann::json values;
};

/// ASIP text without its service, "W,0,90". Fails where encode_text_command() does.
Expected<RequestValues> request_values(const ServiceModel& model, std::string_view text);

}  // namespace asip::model
