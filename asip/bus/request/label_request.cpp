// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/label_request.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::bus {

std::string encode(const model::LabelChange& change, const std::string& by) {
    auto object = model::to_json(change);
    // One that changes nothing is a request, too: it asks for what there is.
    if (object.empty()) object["labels"] = nlohmann::json::object();
    if (!by.empty()) object["by"] = by;
    return model::dump_json(object);
}

bool is_label_request(const nlohmann::json& object) {
    return object.is_object() &&
           (object.contains("labels") || object.contains("names") || object.contains("meanings"));
}

Expected<model::LabelChange> read_label_request(const nlohmann::json& object) {
    std::string fault;
    text::JsonReader reader(object, "", fault);
    auto change = model::read_label_change(reader);
    reader.refuse_others();
    if (!reader.ok()) return fail(fault);
    return change;
}

}  // namespace asip::bus
