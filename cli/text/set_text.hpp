// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "asip/model/service_model.hpp"

namespace asip::cli {

/// One thing that was set in a service: `write` of pin 13 to `high`.
struct SetItem {
    std::string command;
    std::string element;  ///< empty: of the whole service
    std::string value;    ///< by its name where it has one, with its unit
};

/// What an agent says of a service on `BOARD/SERVICE/set`, item by item. `model` may be null.
std::vector<SetItem> set_items(const nlohmann::json& set, const model::ServiceModel* model);
/// `write 13=high, report=100 ms`; empty where nothing is set.
std::string set_text(const nlohmann::json& set, const model::ServiceModel* model);

}  // namespace asip::cli
