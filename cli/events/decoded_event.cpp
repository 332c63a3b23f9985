// SPDX-License-Identifier: Apache-2.0
#include "cli/events/decoded_event.hpp"

#include <algorithm>

#include "asip/model/json.hpp"
#include "cli/output.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

using Json = nlohmann::json;

/// Elements by position: no names are needed beside them.
bool is_plain_list(const Json& value) {
    if (!value.is_array()) return !value.is_object();
    return std::none_of(value.begin(), value.end(), [](const Json& one) { return one.is_structured(); });
}

std::string listed_values(const std::vector<LeafValue>& leaves) {
    return listed(leaves, ", ", &LeafValue::text);
}

std::string slashed(std::string path) {
    std::replace(path.begin(), path.end(), '.', '/');
    return path;
}

std::string dotted(std::string path) {
    std::replace(path.begin(), path.end(), '/', '.');
    return path;
}

/// `distance 42 cm, 118 cm`, or what stands there as JSON where the model does not know it.
std::string member_text(const std::string& service, const model::ServiceModel& model,
                        const std::vector<property::Property>& properties, const std::string& name,
                        const Json& value) {
    const auto* event = model.event_named(name);
    if (event == nullptr) return name + " " + model::dump_json(value);
    auto leaves = leaf_values(model, *event, value);
    say_as_properties(leaves, service, name, properties);
    return name + " " + (is_plain_list(value) ? listed_values(leaves) : leaves_text(leaves));
}

std::string keys_of(const Json& document) {
    std::string keys;
    for (const auto& [name, member] : document.items())
        keys += name + " ";
    return keys;
}

/// `@D,e` of `@D,e,1,{42}`: which of its reports a line is.
std::string head_of(const std::string& line) {
    const auto first = line.find(',');
    return line.substr(0, first == std::string::npos ? 1 : line.find(',', first + 1));
}

/// `field` in a report whose service has no description.
std::optional<DecodedEvent> selected_by_path(const Json& document, const std::string& field) {
    const auto* at = member_at(document, dotted(field));
    if (at == nullptr) return std::nullopt;
    DecodedEvent result;
    result.field = field;
    result.leaves = {{{}, *at, {}}};
    return result;
}

std::optional<DecodedEvent> selected(const std::string& service, const Json& document,
                                     const model::ServiceModel& model,
                                     const std::vector<property::Property>& properties,
                                     const std::string& field) {
    const auto choice = choose_field(model, field);
    if (!choice || !document.contains(choice->event->name)) return std::nullopt;
    DecodedEvent result;
    result.leaves = leaf_values(model, *choice->event, document[choice->event->name]);
    say_as_properties(result.leaves, service, choice->event->name, properties);
    std::erase_if(result.leaves, [&choice](const LeafValue& leaf) { return !choice->takes(leaf.path); });
    if (result.leaves.empty()) return std::nullopt;
    result.field = choice->event->name;
    if (result.leaves.size() == 1 && !result.leaves.front().path.empty())
        result.field += "/" + slashed(result.leaves.front().path);
    return result;
}

std::string whole_text(const std::string& service, const Json& document, const model::ServiceModel& model,
                       const std::vector<property::Property>& properties) {
    std::string text;
    for (const auto& [name, member] : document.items())
        text += (text.empty() ? "" : "; ") + member_text(service, model, properties, name, member);
    return text;
}

}  // namespace

std::string leaves_text(const std::vector<LeafValue>& leaves) {
    if (leaves.size() == 1) return leaves.front().text();
    return listed(leaves, " ", [](const auto& leaf) { return leaf.path + "=" + leaf.text(); });
}

std::optional<DecodedEvent> decode_event(const ContextEvent& event, const model::ServiceModel* model,
                                         const std::vector<property::Property>& properties,
                                         const std::string& field) {
    DecodedEvent plain;
    plain.text = plain.value = event.payload;
    if (event.kind == ContextEvent::Kind::kError) return plain;
    if (event.kind == ContextEvent::Kind::kRaw) {
        plain.what = head_of(event.payload);
        return plain;
    }
    const auto document = model::parse_json(event.payload, {.max_bytes = 1U << 20U, .max_depth = 32});
    if (!document || !document->is_object()) return field.empty() ? std::optional(plain) : std::nullopt;
    if (event.kind == ContextEvent::Kind::kButton) {
        const auto first = document->cbegin();
        plain.text =
            "button " + first.key().substr(event.service.size() + 1) + " " + first->get<std::string>();
        return plain;
    }
    if (field.empty()) {
        plain.what = keys_of(*document);
        if (model != nullptr) plain.text = whole_text(event.service, *document, *model, properties);
        return plain;
    }
    auto result = model != nullptr ? selected(event.service, *document, *model, properties, field)
                                   : selected_by_path(*document, field);
    if (!result) return std::nullopt;
    result->what = result->field;
    result->value = leaves_text(result->leaves);
    result->text = result->field + " " + result->value;
    return result;
}

}  // namespace asip::cli
