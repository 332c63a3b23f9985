// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/agent_requests.hpp"

#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
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

std::string encode(const PortRequest& request, const std::string& by) {
    nlohmann::json object{{"port", "take"}, {"by", by}};
    if (request.what == PortRequest::What::kRelease) {
        object["port"] = "release";
        object["seconds"] = request.time.count();
    } else if (request.what == PortRequest::What::kLoad) {
        object["port"] = "load";
        if (!request.firmware.empty()) object["firmware"] = request.firmware;
        if (!request.board.empty()) object["board"] = request.board;
        if (request.force) object["force"] = true;
        if (request.update) object["update"] = true;
    }
    return model::dump_json(object);
}

bool is_port_request(const nlohmann::json& object) {
    return object.is_object() && object.contains("port");
}

Expected<PortRequest> read_port_request(const nlohmann::json& object) {
    std::string fault;
    text::JsonReader reader(object, "", fault);
    PortRequest request;
    const auto what = reader.text("port");
    if (what == "take") {
        request.what = PortRequest::What::kTake;
    } else if (what == "load") {
        request.what = PortRequest::What::kLoad;
        request.firmware = reader.text("firmware");
        request.board = reader.text("board");
        request.force = reader.flag("force");
        request.update = reader.flag("update");
        // It becomes the name of a file.
        if (!(request.update && request.firmware.empty()) && !model::valid_name(request.firmware))
            reader.fault("firmware", "is not a name such as AsipServices");
    } else if (what != "release") {
        reader.fault("port", "is none of \"release\", \"take\" and \"load\"");
    } else if (const auto seconds =
                   reader.integer("seconds", PortRequest::kMinTime.count(), PortRequest::kMaxTime.count())) {
        request.time = std::chrono::seconds(*seconds);
    }
    reader.refuse_others();
    if (!reader.ok()) return fail(fault);
    return request;
}

}  // namespace asip::bus
