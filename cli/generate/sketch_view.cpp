// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/sketch_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "cli/generate/firmware_model.hpp"
#include "cli/generate/firmware_type.hpp"
#include "cli/generate/generate.hpp"
#include "cli/generate/layout.hpp"
#include "cli/generate/names.hpp"

namespace asip::generate {
namespace {

using model::CommandModel;
using model::EventModel;
using model::EventShape;
using model::Field;
using model::ServiceModel;
using model::ValueType;
using nlohmann::json;

constexpr std::size_t kUsualListBytes = 56;  // of a request of 62, behind `S,t,9,{`

class SketchView {
  public:
    SketchView(const ServiceModel& model, const std::string& sketch, std::size_t elements)
        : model_(model), stand_ins_(stand_ins(model, elements)), members_("C++"), pins_("C++") {
        const auto* reported = reported_event(model);
        const auto class_name = pascal_case(model.name) + "Service";
        view_ = {{"class", class_name},
                 {"sketch", sketch},
                 {"ref", model.ref()},
                 {"title", comment(model.title)},
                 {"hardware", pascal_case(model.name) + "Hardware.cpp"},
                 {"letter", std::string(1, model.id)},
                 {"announced", announced_name(model)},
                 {"elements", std::to_string(elements)},
                 {"reported", std::to_string(reported_count(reported, elements))},
                 {"events", json::array()},
                 {"commands", json::array()},
                 {"structs", json::array()},
                 {"pins", json::array()}};
        for (const auto& event : model.events)
            add_event(event, &event == reported);
        for (const auto& command : model.commands)
            if (reported == nullptr || command.tag != 'A') add_command(command);
        add_flags(reported);
    }

    /// Two names that became one; empty: none did.
    std::string fault() const {
        for (const auto& fault : {fault_, members_.fault(), pins_.fault()})
            if (!fault.empty()) return fault;
        return {};
    }
    const json& view() const { return view_; }

  private:
    static std::size_t reported_count(const EventModel* reported, std::size_t elements) {
        if (reported == nullptr) return 0;
        if (reported->shape == EventShape::kPerElement) return elements;
        return reported->shape == EventShape::kOnce ? reported->fields.size() : 1;
    }

    const StandIn* stand_in(const Field& field) const {
        const auto found = std::find_if(stand_ins_.begin(), stand_ins_.end(),
                                        [&](const StandIn& one) { return one.field == &field; });
        return found == stand_ins_.end() ? nullptr : &*found;
    }

    /// The pins of a stand-in in the view; their constant's name.
    std::string add_pins(const StandIn& stand_in) {
        const auto name =
            fmt::format("k{}{}", pascal_case(stand_in.value), stand_in.output ? "Outputs" : "Inputs");
        std::vector<std::string> names;
        for (const int pin : stand_in.pins)
            names.push_back(pin_name(pin));
        pins_.add(name, "value " + stand_in.value);
        view_["pins"].push_back({{"name", name},
                                 {"count", std::to_string(names.size())},
                                 {"pins", fmt::format("{}", fmt::join(names, ", "))},
                                 {"output", stand_in.output},
                                 {"value", stand_in.value}});
        return name;
    }

    void add_event(const EventModel& event, bool reported) {
        const bool elements = event.shape == EventShape::kPerElement;
        const auto send = "send" + pascal_case(event.name);
        members_.add(send, "event " + event.name);
        json fields = json::array();
        for (const auto& field : event.fields) {
            auto read = "read" + pascal_case(event.name);
            if (event.fields.size() > 1) read += pascal_case(field.name);
            members_.add(read, "event " + event.name);
            json one = {{"read", read},
                        {"type", firmware_type(field)},
                        {"write", firmware_write(field, read + (elements ? "(index)" : "()"))},
                        {"index", std::to_string(fields.size())},
                        {"more", !fields.empty()},
                        {"parameter", elements ? "uint8_t " + element_name() : ""},
                        {"element", element_name()},
                        {"what", comment(model::describe(field))},
                        {"none", field.type == ValueType::kText ? "\"\"" : "0"}};
            if (const auto* stands = stand_in(field))
                one["stand_in"] = {{"pins", add_pins(*stands)},
                                   {"at", elements ? element_name() : "0"},
                                   {"digital", stands->digital},
                                   {"decimal", field.type == ValueType::kNumber},
                                   {"low", std::to_string(stands->low)},
                                   {"range", std::to_string(stands->high - stands->low)},
                                   {"high", std::to_string(stands->high)}};
            else
                one["unused"] = elements;
            fields.push_back(std::move(one));
        }
        const bool asked =
            std::any_of(model_.commands.begin(), model_.commands.end(),
                        [&](const CommandModel& command) { return command.answer == event.tag; });
        view_["events"].push_back({{"tag", cpp_character(event.tag)},
                                   {"name", event.name},
                                   {"title", comment(event.title.empty() ? event.name : event.title)},
                                   {"send", send},
                                   {"list", is_list(event)},
                                   {"per_element", elements},
                                   {"count", elements ? "kElements" : std::to_string(event.fields.size())},
                                   {"unasked", !asked && !reported},
                                   {"fields", std::move(fields)}});
    }

    std::string element_name() const { return model_.element.empty() ? "index" : camel_case(model_.element); }

    void add_command(const CommandModel& command) {
        const auto method = pascal_case(command.name);
        members_.add("do" + method, "command " + command.name);
        Scope arguments("C++");
        json view = {{"tag", cpp_character(command.tag)},
                     {"name", command.name},
                     {"title", comment(command.title.empty() ? command.name : command.title)},
                     {"parse", "parse" + method},
                     {"do", "do" + method},
                     {"acts", command.answer == 0 || !command.args.empty()},
                     {"arguments", json::array()},
                     {"parameters", json::array()},
                     {"stand_ins", json::array()},
                     {"unused", json::array()},
                     {"checks", json::array()}};
        if (command.answer != 0) view["answer"] = "send" + pascal_case(model_.event(command.answer)->name);
        const auto* element = element_argument(model_, command);
        bool element_used = false;
        for (const auto& argument : command.args) {
            const auto name = camel_case(argument.name);
            arguments.add(name, command.name + "'s argument " + argument.name);
            if (argument.type == ValueType::kList) {
                arguments.add(name + "Count", command.name + "'s argument " + argument.name);
                add_list(command, argument, view);
                continue;
            }
            view["arguments"].push_back(argument_view(argument, name, &argument == element));
            if (argument.type == ValueType::kCount) continue;
            add_parameter(view, &argument == element ? "uint8_t" : firmware_type(argument), name,
                          &argument == element ? fmt::format("static_cast<uint8_t>({})", name) : name);
            if (&argument == element) continue;
            const auto* stands = stand_in(argument);
            if (stands == nullptr) {
                view["unused"].push_back({{"name", name}});
                continue;
            }
            element_used = element_used || element != nullptr;
            view["stand_ins"].push_back(
                {{"pins", add_pins(*stands)},
                 {"at", element == nullptr ? "0" : camel_case(element->name)},
                 {"digital", stands->digital},
                 {"value",
                  argument.type == ValueType::kNumber ? fmt::format("static_cast<long>({})", name) : name},
                 {"low", std::to_string(stands->low)},
                 {"high", std::to_string(stands->high)}});
        }
        if (element != nullptr) {
            view["element"] = camel_case(element->name);
            if (!element_used) view["unused"].push_back({{"name", camel_case(element->name)}});
        }
        if (fault_.empty()) fault_ = arguments.fault();
        if (!view["parameters"].empty()) view["parameters"].back()["last"] = true;
        view_["commands"].push_back(std::move(view));
    }

    static void add_parameter(json& view, const std::string& type, const std::string& name,
                              const std::string& passed) {
        view["parameters"].push_back({{"type", type}, {"name", name}, {"passed", passed}});
    }

    /// How one argument is read; lists are read by add_list().
    json argument_view(const Field& argument, const std::string& name, bool is_element) {
        json view = {{"name", name}, {"what", comment(model::describe(argument))}};
        const auto low_and_high = whole_range(argument);
        if (is_element) {  // whatever the model allows: no element is below 0
            const auto most = std::clamp(low_and_high.high, 0.0, kMaxUnsigned16Bits);
            view["plain"] = {{"type", "uint16_t"}, {"read", fmt::format("number({:.0f})", most)}};
        } else if (argument.type == ValueType::kCount) {
            view["plain"] = {{"type", "uint16_t"}, {"read", "number(65535)"}};
        } else if (argument.type == ValueType::kText) {
            view["text"] = {{"longest", std::to_string(argument.max_length.value_or(kUsualListBytes))}};
        } else if (argument.type == ValueType::kNumber) {
            constexpr double kAny = 1e9;
            view["decimal"] = {{"low", decimal_literal(std::max(argument.min.value_or(-kAny), -kAny))},
                               {"high", decimal_literal(std::min(argument.max.value_or(kAny), kAny))}};
            view_["reads_decimal"] = true;
        } else if (firmware_type(argument) == "int32_t") {
            view["whole"] = {{"low", whole_literal(low_and_high.low)},
                             {"high", whole_literal(low_and_high.high)}};
            view_["reads_whole"] = true;
        } else {
            const bool is_signed = firmware_type(argument) == "int16_t";
            const double most = std::max(low_and_high.high, -low_and_high.low);
            view["plain"] = {
                {"type", firmware_type(argument)},
                {"read", fmt::format("{}({:.0f})", is_signed ? "signedNumber" : "number", most)}};
            if (low_and_high.low > (is_signed ? -most : 0))
                view["plain"]["low"] = whole_literal(low_and_high.low);
            if (low_and_high.high < most) view["plain"]["high"] = whole_literal(low_and_high.high);
        }
        return view;
    }

    void add_list(const CommandModel& command, const Field& list, json& view) {
        const auto name = camel_case(list.name);
        const auto most =
            std::min(list.max_length.value_or(kUsualListBytes), kUsualListBytes / (2 * list.items.size()));
        const bool one = list.items.size() == 1;
        const auto type = one ? firmware_type(list.items.front())
                              : pascal_case(command.name) + pascal_case(list.name) + "Item";
        json fields = json::array();
        Scope items("C++");
        for (const auto& item : list.items) {
            items.add(camel_case(item.name), list.name + "'s " + item.name);
            const auto range = whole_range(item);
            fields.push_back({{"name", camel_case(item.name)},
                              {"place", one ? "item" : "item." + camel_case(item.name)},
                              {"type", firmware_type(item)},
                              {"more", !fields.empty()},
                              {"low", whole_literal(range.low)},
                              {"high", whole_literal(range.high)}});
        }
        if (fault_.empty()) fault_ = items.fault();
        if (!one) {
            members_.add(type, "command " + command.name);
            view_["structs"].push_back({{"type", type}, {"fields", fields}, {"of", command.name}});
        }
        view["arguments"].push_back({{"name", name},
                                     {"what", comment(model::describe(list))},
                                     {"list",
                                      {{"type", type},
                                       {"count", name + "Count"},
                                       {"most", std::to_string(most)},
                                       {"braces", list.braces},
                                       {"fields", fields}}}});
        view_["reads_whole"] = true;
        for (const auto& argument : command.args)
            if (argument.type == ValueType::kCount && argument.of == list.name)
                view["checks"].push_back(
                    {{"if", fmt::format("{} != {}Count", camel_case(argument.name), name)}});
        add_parameter(view, fmt::format("const {}*", type), name, name);
        add_parameter(view, "uint8_t", name + "Count", name + "Count");
        view["unused"].push_back({{"name", name}});
        view["unused"].push_back({{"name", name + "Count"}});
    }

    void add_flags(const EventModel* reported) {
        const auto any = [this](const char* flag) {
            return std::any_of(view_["events"].begin(), view_["events"].end(),
                               [flag](const json& event) { return event[flag] == true; });
        };
        view_["has_lists"] = any("list");
        view_["has_unasked"] = any("unasked");
        view_["has_commands"] = !view_["commands"].empty();
        view_["has_pins"] = !view_["pins"].empty();
        if (reported != nullptr && (!is_list(*reported) || reported->tag != 'e'))
            view_["reports_otherwise"] = {{"send", "send" + pascal_case(reported->name)}};
    }

    const ServiceModel& model_;
    std::vector<StandIn> stand_ins_;
    Scope members_, pins_;
    std::string fault_;
    json view_;
};

}  // namespace

Expected<json> sketch_view(const ServiceModel& model, const std::string& sketch, std::size_t elements) {
    const SketchView view(model, sketch, elements);
    if (const auto fault = view.fault(); !fault.empty()) return fail(fault);
    return view.view();
}

}  // namespace asip::generate
