// SPDX-License-Identifier: Apache-2.0
#include "asip/model/schema.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "asip/model/embedded.hpp"
#include "asip/model/json.hpp"
#include "asip/text/printable.hpp"

namespace asip::model {
namespace {

using nlohmann::json;

// std::regex recurses for each character it matches.
constexpr std::size_t kMaxMatchedBytes = 256;
constexpr int kMaxReferences = 64;

class Checker {
  public:
    explicit Checker(const json& root) : root_(root) {}

    Expected<void> check(const json& schema, const json& value, const std::string& place,
                         int references = 0) const;

  private:
    using Result = Expected<void>;

    Result check_object(const json& schema, const json& value, const std::string& place) const;
    Result check_array(const json& schema, const json& value, const std::string& place) const;
    Result check_string(const json& schema, const json& value, const std::string& place) const;
    Result check_reference(const json& reference, const json& value, const std::string& place,
                           int references) const;

    const json& root_;
};

Unexpected<std::string> fault(const std::string& place, const std::string& reason) {
    return fail((place.empty() ? "/" : text::printable(place, 256)) + ": " + reason);
}

std::string shown_in_fault(const json& value) {
    const auto text = dump_json(value);
    return text.size() > 60 ? text.substr(0, 60) + "..." : text;
}

bool has_type(const json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    return type == "null" && value.is_null();
}

/// The number under a keyword, where the keyword is there.
std::optional<double> number_at(const json& schema, const char* keyword) {
    const auto found = schema.find(keyword);
    if (found == schema.end() || !found->is_number()) return std::nullopt;
    return found->get<double>();
}

std::string plain(double number) {
    const auto whole = static_cast<std::int64_t>(number);
    return static_cast<double>(whole) == number ? dump_json(json(whole)) : dump_json(json(number));
}

bool matches_pattern(const std::string& text, const std::string& pattern) {
    static thread_local std::map<std::string, std::regex> compiled;
    auto found = compiled.find(pattern);
    if (found == compiled.end()) found = compiled.emplace(pattern, std::regex(pattern)).first;
    return text.size() <= kMaxMatchedBytes && std::regex_search(text, found->second);
}

const json* unknown_keyword(const json& schema) {
    constexpr std::string_view known =
        " $schema $id $ref $comment title description type enum const pattern minLength maxLength minimum "
        "maximum items minItems maxItems properties required propertyNames additionalProperties anyOf "
        "default examples minProperties maxProperties definitions patternProperties ";
    for (auto it = schema.begin(); it != schema.end(); ++it)
        if (known.find(' ' + it.key() + ' ') == std::string_view::npos) return &it.value();
    return nullptr;
}

Expected<void> Checker::check(const json& schema, const json& value, const std::string& place,
                              int references) const {
    if (schema.is_boolean()) return schema.get<bool>() ? Result{} : fault(place, "is not allowed here");
    if (!schema.is_object()) return fault(place, "the schema is neither an object nor a boolean here");
    if (unknown_keyword(schema) != nullptr)
        return fault(place, "the schema uses a keyword that is not supported");
    if (const auto found = schema.find("$ref"); found != schema.end())
        return check_reference(*found, value, place, references);
    if (const auto found = schema.find("type");
        found != schema.end() && !has_type(value, found->get<std::string>())) {
        return fault(place, "is " + shown_in_fault(value) + ", not of type " + found->get<std::string>());
    }
    if (const auto found = schema.find("enum"); found != schema.end()) {
        if (std::find(found->begin(), found->end(), value) == found->end())
            return fault(place, "is " + shown_in_fault(value) + ", not one of " + dump_json(*found));
    }
    if (const auto found = schema.find("const"); found != schema.end() && *found != value)
        return fault(place, "is not " + shown_in_fault(*found));
    if (value.is_number()) {
        const auto minimum = number_at(schema, "minimum");
        const auto maximum = number_at(schema, "maximum");
        if (minimum && value.get<double>() < *minimum)
            return fault(place, shown_in_fault(value) + " is below " + plain(*minimum));
        if (maximum && value.get<double>() > *maximum)
            return fault(place, shown_in_fault(value) + " is above " + plain(*maximum));
    }
    if (const auto found = schema.find("anyOf"); found != schema.end()) {
        const auto fits = [&](const json& option) {
            return check(option, value, place, references + 1).has_value();
        };
        if (references > kMaxReferences) return fault(place, "the schema refers to itself without end");
        if (std::none_of(found->begin(), found->end(), fits))
            return fault(place, "fits none of the forms allowed here");
    }
    if (value.is_string()) return check_string(schema, value, place);
    if (value.is_array()) return check_array(schema, value, place);
    if (value.is_object()) return check_object(schema, value, place);
    return {};
}

Expected<void> Checker::check_reference(const json& reference, const json& value, const std::string& place,
                                        int references) const {
    static const std::string kDefinitions = "#/definitions/";
    const auto& name = reference.get_ref<const std::string&>();
    if (references > kMaxReferences) return fault(place, "the schema refers to itself without end");
    const auto definitions = root_.find("definitions");
    if (!name.starts_with(kDefinitions) || definitions == root_.end())
        return fault(place, "the schema's reference " + name + " leads nowhere");
    const auto found = definitions->find(name.substr(kDefinitions.size()));
    if (found == definitions->end()) return fault(place, "the schema's reference " + name + " leads nowhere");
    return check(*found, value, place, references + 1);
}

Expected<void> Checker::check_string(const json& schema, const json& value, const std::string& place) const {
    const auto& text = value.get_ref<const std::string&>();
    const auto shortest = number_at(schema, "minLength");
    const auto longest = number_at(schema, "maxLength");
    if (shortest && static_cast<double>(text.size()) < *shortest)
        return fault(place, "is shorter than " + plain(*shortest) + " bytes");
    if (longest && static_cast<double>(text.size()) > *longest)
        return fault(place, "is longer than " + plain(*longest) + " bytes");
    const auto pattern = schema.find("pattern");
    if (pattern != schema.end() && !matches_pattern(text, pattern->get<std::string>()))
        return fault(place, shown_in_fault(value) + " does not match " + pattern->get<std::string>());
    return {};
}

Expected<void> Checker::check_array(const json& schema, const json& value, const std::string& place) const {
    const auto fewest = number_at(schema, "minItems");
    const auto most = number_at(schema, "maxItems");
    if (fewest && static_cast<double>(value.size()) < *fewest)
        return fault(place, "has fewer than " + plain(*fewest) + " items");
    if (most && static_cast<double>(value.size()) > *most)
        return fault(place, "has more than " + plain(*most) + " items");
    const auto items = schema.find("items");
    if (items == schema.end()) return {};
    for (std::size_t i = 0; i < value.size(); ++i)
        if (auto result = check(*items, value[i], place + "/" + std::to_string(i)); !result) return result;
    return {};
}

Expected<void> Checker::check_object(const json& schema, const json& value, const std::string& place) const {
    const auto fewest = number_at(schema, "minProperties");
    const auto most = number_at(schema, "maxProperties");
    if (fewest && static_cast<double>(value.size()) < *fewest)
        return fault(place, "has fewer than " + plain(*fewest) + " members");
    if (most && static_cast<double>(value.size()) > *most)
        return fault(place, "has more than " + plain(*most) + " members");
    if (const auto required = schema.find("required"); required != schema.end()) {
        for (const auto& name : *required)
            if (!value.contains(name.get<std::string>()))
                return fault(place, "has no member " + shown_in_fault(name));
    }
    const auto properties = schema.find("properties");
    const auto patterns = schema.find("patternProperties");
    const auto others = schema.find("additionalProperties");
    const auto names = schema.find("propertyNames");
    for (auto it = value.begin(); it != value.end(); ++it) {
        const auto inner = place + "/" + it.key();
        if (names != schema.end()) {
            if (auto result = check(*names, json(it.key()), inner); !result) return result;
        }
        bool known = false;
        if (properties != schema.end() && properties->contains(it.key())) {
            known = true;
            if (auto result = check((*properties)[it.key()], it.value(), inner); !result) return result;
        }
        if (patterns != schema.end()) {
            for (auto pattern = patterns->begin(); pattern != patterns->end(); ++pattern) {
                if (!matches_pattern(it.key(), pattern.key())) continue;
                known = true;
                if (auto result = check(pattern.value(), it.value(), inner); !result) return result;
            }
        }
        if (known || others == schema.end()) continue;
        if (others->is_boolean() && !others->get<bool>()) return fault(inner, "no such member is known here");
        if (auto result = check(*others, it.value(), inner); !result) return result;
    }
    return {};
}

}  // namespace

const nlohmann::json& service_model_schema() {
    static const json schema = json::parse(embedded_schema());
    return schema;
}

Expected<void> check_schema(const nlohmann::json& schema, const nlohmann::json& document) {
    // A schema is ours, not input: one that is broken throws, and that is turned into a reason here.
    try {
        return Checker(schema).check(schema, document, "");
    } catch (const std::exception& error) {
        return fail(std::string("/: the schema itself is broken: ") + error.what());
    }
}

}  // namespace asip::model
