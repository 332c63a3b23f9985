// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "gateway/api/openapi_schemas.hpp"
#include "gateway/api/routes.hpp"

namespace asip::gateway::api {
namespace {

using nlohmann::json;

json reference(std::string_view schema) {
    return {{"$ref", "#/components/schemas/" + std::string(schema)}};
}

json path_parameters(std::string_view path) {
    json list = json::array();
    for (auto open = path.find('{'); open != std::string_view::npos; open = path.find('{', open + 1)) {
        const auto name = path.substr(open + 1, path.find('}', open) - open - 1);
        list.push_back(
            {{"name", name}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}}}});
    }
    return list;
}

json header_parameter(const char* name, const char* about) {
    return {{"name", name}, {"in", "header"}, {"description", about}, {"schema", {{"type", "string"}}}};
}

json parameters_of(const Route& route) {
    json list = path_parameters(route.path);
    for (const auto& parameter : route.query) {
        json item{{"name", parameter.name},
                  {"in", "query"},
                  {"description", parameter.about},
                  {"schema", json::parse(parameter.schema)}};
        if (!parameter.example.empty()) item["example"] = json::parse(parameter.example);
        list.push_back(std::move(item));
    }
    const auto answers = [&](int status) {
        return std::any_of(route.answers.begin(), route.answers.end(),
                           [&](const Answer& each) { return each.status == status; });
    };
    if (answers(304))
        list.push_back(header_parameter("If-None-Match", "The ETag of the version that is known"));
    if (answers(412)) list.push_back(header_parameter("If-Match", "The ETag of the version that is changed"));
    if (answers(428))
        list.push_back(header_parameter("If-None-Match", "`*`: only where there is none of this name"));
    if (!route.query.empty() && route.query.back().name == "last_event_id")
        list.push_back(header_parameter("Last-Event-ID", "Resume behind this event"));
    if (answers(504))
        list.push_back(
            header_parameter("Idempotency-Key", "The same command with the same key is executed once"));
    if (route.need == Need::kCommand || route.need == Need::kUse || route.need == Need::kLabel ||
        route.need == Need::kRaw)
        list.push_back(
            header_parameter("Asip-Session", "Keys belong to a session; for clients of one token"));
    return list;
}

json response(const Answer& answer) {
    json object{{"description", answer.about}};
    if (!answer.schema.empty())
        object["content"][std::string(answer.type)]["schema"] = reference(answer.schema);
    return object;
}

json responses_of(const Route& route) {
    json object;
    for (const auto& answer : route.answers)
        object[std::to_string(answer.status)] = response(answer);
    const auto add = [&](int status, const char* name) {
        object.emplace(std::to_string(status), json{{"$ref", std::string("#/components/responses/") + name}});
    };
    add(400, "BadRequest");
    add(421, "WrongHost");
    if (route.need != Need::kNothing) add(401, "Unauthorized");
    const bool changes = route.method != "GET";
    if (changes || route.need > Need::kRead) add(403, "Forbidden");
    if (route.method == "POST" || route.method == "PUT") add(415, "WrongType");
    return object;
}

json operation(const Route& route) {
    json object{{"operationId", route.id}, {"summary", route.about}, {"responses", responses_of(route)}};
    if (auto parameters = parameters_of(route); !parameters.empty())
        object["parameters"] = std::move(parameters);
    if (!route.body.empty()) {
        auto& content = object["requestBody"]["content"]["application/json"];
        content["schema"] = reference(route.body);
        if (route.body == "Dashboard") content["example"] = json::parse(kDashboardExample);
        if (route.id == "sendRaw" || route.id == "writeProperty" || route.id == "putDashboard")
            object["requestBody"]["required"] = true;
    }
    if (route.need == Need::kNothing) object["security"] = json::array();
    return object;
}

}  // namespace

std::string openapi_document(const std::vector<Route>& routes, const std::string& base_path) {
    json document{{"openapi", "3.1.0"},
                  {"info",
                   {{"title", "ASIP gateway"},
                    {"version", ASIP_VERSION},
                    {"description", "Boards and services of an ASIP service bus"},
                    {"license", {{"name", "Apache-2.0"}, {"identifier", "Apache-2.0"}}}}},
                  {"servers", {{{"url", base_path + "/"}}}},
                  {"security", json::parse(R"([{"token":[]},{"cookie":[]},{}])")},
                  {"components", json::parse(kComponents)}};
    for (const auto& route : routes)
        document["paths"][std::string(route.path)][http::lower(route.method)] = operation(route);
    return model::dump_json(document);
}

}  // namespace asip::gateway::api
