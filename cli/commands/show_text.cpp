// SPDX-License-Identifier: Apache-2.0
// Boards and services as text, and pins as records.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/registry/board_match.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/property/words.hpp"
#include "asip/protocol/pin.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/commands/list.hpp"
#include "cli/commands/show.hpp"
#include "cli/output.hpp"
#include "cli/text/width.hpp"
#include "cli/text/words.hpp"

namespace asip::cli {
namespace {

constexpr std::size_t kLabelColumns = 11;

std::string labelled(const std::string& label, const std::string& value, bool colour,
                     Colour value_colour = Colour::kNone) {
    if (value.empty()) return {};
    const std::string blanks(kLabelColumns - std::min(kLabelColumns, label.size()), ' ');
    return painted(label, Colour::kDim, colour) + blanks +
           painted(for_terminal(value), value_colour, colour) + "\n";
}

std::string extensions_text(const model::Description& description) {
    if (description.firmware.protocol.empty()) return {};
    const auto text = listed(description.firmware.extensions.list, " ", [](const auto& each) {
        return std::string(1, each.first) + ":" + std::to_string(each.second);
    });
    return text.empty() ? "none (ASIP 0.4)" : text;
}

std::string link_text(const model::LinkInfo& link) {
    auto text = link.kind + (link.path.empty() ? "" : " " + link.path);
    if (link.baud > 0) text += " at " + std::to_string(link.baud) + " baud";
    return text;
}

std::string presence_text(const bus::BoardItem& item) {
    std::string text;
    const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (item.age >= 0) add(text::duration_text(std::chrono::duration<double>(item.age)) + " ago");
    if (item.first_seen != text::WallTime{}) add("first " + text::iso_time(item.first_seen));
    if (item.since != text::WallTime{}) add(item.state + " since " + text::iso_time(item.since));
    return text;
}

std::vector<std::string> capabilities(char digit) {
    const int bits = digit >= '0' && digit <= '7' ? digit - '0' : 0;
    std::vector<std::string> words;
    if ((bits & protocol::kCapabilityDigital) != 0) words.emplace_back("digital");
    if ((bits & protocol::kCapabilityAnalogIn) != 0) words.emplace_back("analog");
    if ((bits & protocol::kCapabilityPwm) != 0) words.emplace_back("pwm");
    return words;
}

std::string mode_text(char digit) {
    const auto mode = protocol::pin_mode_from_number(digit - '0');
    return mode ? std::string(protocol::to_text(*mode)) : std::string();
}

std::string owner_text(const model::Description& description, char owner) {
    if (owner == '@') return "system";
    for (const auto& service : description.services)
        if (service.id == owner && owner != 0) return service.name;
    return owner == '-' || owner == 0 ? "" : std::string(1, owner);
}

char at(const std::string& text, std::size_t index) {
    return index < text.size() ? text[index] : '\0';
}

std::string pin_name(const model::Description& description, std::size_t pin) {
    for (const auto& [digital, channel] : description.pins.analog)
        if (digital == pin) return std::to_string(pin) + " (A" + std::to_string(channel) + ")";
    return std::to_string(pin);
}

std::string on_demand_text(const model::OnDemandInfo& reports) {
    return "on demand, every " + std::to_string(reports.fastest) + " ms at the fastest; " +
           (reports.resting == 0 ? std::string("none") : "every " + std::to_string(reports.resting) + " ms") +
           " while no program subscribes";
}

/// The program that has the board's port, and until when; empty: its agent.
std::string updating_text(const bus::BoardItem& item) {
    if (item.state != "updating") return {};
    const auto document = model::parse_json(item.description);
    if (!document || !document->contains("updating")) return {};
    return "with " + value_at(*document, "updating.by") + " until " + value_at(*document, "updating.until");
}

std::string values_text(const KnownProperties& known, std::string_view service) {
    std::string text;
    for (const auto& [property, value] : known)
        if (property.service == service)
            text += (text.empty() ? "" : ", ") + property.id + " " + property::value_text(property, value);
    return text;
}

}  // namespace

std::string field_text(const model::Field& field) {
    auto text = field.name;
    if (!field.names.empty()) {
        std::string names;
        for (const auto& [name, number] : field.names)
            names += (names.empty() ? " " : "|") + name;
        text += names;
    } else if (field.min && field.max) {
        const auto number = [](double value) {
            auto written = std::to_string(value);
            written.erase(written.find_last_not_of('0') + 1);
            if (written.back() == '.') written.pop_back();
            return written;
        };
        text += " " + number(*field.min) + ".." + number(*field.max);
    } else if (field.type != model::ValueType::kInteger) {
        text += " " + std::string(to_text(field.type));
    }
    return field.unit.empty() ? text : text + " " + field.unit;
}

std::vector<nlohmann::json> pin_records(const model::Description& description) {
    const auto& pins = description.pins;
    const auto count = std::max({pins.capabilities.size(), pins.owners.size(), pins.modes.size()});
    std::vector<nlohmann::json> records;
    for (std::size_t pin = 0; pin < count; ++pin) {
        nlohmann::json record{{"board", description.board}, {"pin", pin}};
        if (const auto mode = mode_text(at(pins.modes, pin)); !mode.empty()) record["mode"] = mode;
        if (const auto owner = owner_text(description, at(pins.owners, pin)); !owner.empty())
            record["owner"] = owner;
        record["can"] = capabilities(at(pins.capabilities, pin));
        for (const auto& [digital, channel] : pins.analog)
            if (digital == pin) record["channel"] = channel;
        if (auto name = description.labels.pin(static_cast<int>(pin)); !name.empty())
            record["label"] = std::move(name);
        records.push_back(std::move(record));
    }
    return records;
}

std::string pins_text(const model::Description& description, std::size_t width, bool colour) {
    const auto& pins = description.pins;
    const auto count = std::max({pins.capabilities.size(), pins.owners.size(), pins.modes.size()});
    if (count == 0) return {};
    std::vector<Column> columns{{"PIN"}, {"MODE"}, {"OWNER", false, 6}, {"CAN", false, 6}};
    const bool named = !description.labels.pins.empty();
    if (named) columns.push_back({"NAME", false, 8});
    Table table(std::move(columns));
    for (std::size_t pin = 0; pin < count; ++pin) {
        const auto owner = at(pins.owners, pin);
        const auto tint = owner == '@' ? Colour::kDim : Colour::kNone;
        std::vector<Cell> row{Cell(pin_name(description, pin), tint),
                              Cell(mode_text(at(pins.modes, pin)), tint),
                              Cell(owner_text(description, owner), tint),
                              Cell(listed(capabilities(at(pins.capabilities, pin)), " "), tint)};
        if (named) row.emplace_back(description.labels.pin(static_cast<int>(pin)));
        table.add(std::move(row));
    }
    return table.render(width, colour);
}

std::string model_text(const model::ServiceModel& model, std::size_t width, bool colour) {
    std::string text;
    if (!model.events.empty()) {
        Table events({{"REPORTS"}, {"FIELDS", false, 10}, {"", false, 10}});
        for (const auto& event : model.events)
            events.add({event.name, listed(event.fields, ", ", field_text), event.title});
        text += "\n" + events.render(width, colour);
    }
    if (!model.commands.empty()) {
        Table commands({{"COMMAND"}, {"ARGUMENTS", false, 10}, {"", false, 10}});
        for (const auto& command : model.commands) {
            std::string args;
            for (const auto& field : command.args) {
                if (field.type == model::ValueType::kCount) continue;
                args += (args.empty() ? "" : ", ") + field_text(field);
            }
            commands.add({command.name, args, command.title});
        }
        text += "\n" + commands.render(width, colour);
    }
    std::string undone;
    for (const auto& command : model.commands)
        if (const auto safe = model::safe_usage(model, command); !safe.empty())
            undone += (undone.empty() ? "" : "; ") + command.name + ": " + safe;
    return undone.empty() ? text : text + "\nundone by  " + undone + "\n";
}

std::string service_text(const std::string& board, const model::ServiceInfo& service,
                         const std::string& label, const model::ServiceModel* model, std::size_t width,
                         bool colour, const KnownProperties& known) {
    auto text = painted(for_terminal(board + "/" + service.name), Colour::kBold, colour);
    const auto title = model != nullptr ? model->title : service.title;
    if (!title.empty()) text += "  " + for_terminal(title);
    text += "\n";
    const auto named = service.id == 0 ? std::string() : std::string(1, service.id) + " " + service.title;
    text += labelled("name", label, colour) + labelled("on board", named, colour);
    if (service.count) {
        const auto element = model != nullptr && !model->element.empty() ? model->element : "element";
        text += labelled(
            "has", std::to_string(*service.count) + " " + element + (*service.count == 1 ? "" : "s"), colour);
    }
    if (service.period)
        text += labelled("period", *service.period == 0 ? "off" : std::to_string(*service.period) + " ms",
                         colour);
    text += labelled("values", values_text(known, service.name), colour);
    if (model == nullptr) {
        return text + labelled("model",
                               "none known: events come as tag and body, commands go as tag and parameters, "
                               "as in  asipctl send " +
                                   board + "/" + service.name + " A 100",
                               colour);
    }
    return text + labelled("model", model->ref(), colour) + model_text(*model, width, colour);
}

std::string board_text(const KnownBoard& board, const model::ModelSet& models, std::size_t width, bool colour,
                       const KnownProperties& known) {
    const auto& item = board.item;
    const auto brief = bus::brief_of({&item, 1});
    const auto state = state_cell(brief.rows().front());
    auto text = painted(for_terminal(item.board), Colour::kBold, colour) + "  " +
                painted(for_terminal(state.text), state.colour, colour) + "\n";
    if (!item.reported.empty() && item.reported != item.state)
        text += labelled("reported", item.reported, colour);
    if (item.conflict) {
        text += labelled("CONFLICT",
                         "two agents claim this name: session " + item.conflict->holder + " and " +
                             item.conflict->other + " (" + item.conflict->other_agent + ")",
                         colour, Colour::kRed);
    }
    if (board.description && board.description->stopped) {
        const auto& stop = *board.description->stopped;
        text += labelled("STOPPED",
                         "by " + (stop.by.empty() ? std::string("an unnamed user") : stop.by) +
                             (stop.why.empty() ? "" : ": " + stop.why) + "; asipctl resume " + item.board,
                         colour, Colour::kRed);
    }
    text += labelled("port", updating_text(item), colour);
    text += labelled("announced", presence_text(item), colour);
    if (!board.description) {
        text += board.description_fault.empty()
                    ? labelled("known by", "its names only; it " + board.why_no_description(), colour)
                    : labelled("known by", "a description that is not valid: " + board.description_fault,
                               colour, Colour::kRed);
    } else {
        const auto& all = *board.description;
        const auto& firmware = all.firmware;
        text += labelled("chip", firmware.chip, colour) +
                labelled("sketch", bus::firmware_text(firmware.sketch, firmware.version, firmware.available),
                         colour);
        if (!firmware.available.empty())
            text += labelled("newer", firmware.available + "; asipctl flash --update " + item.board, colour,
                             Colour::kYellow);
        text += labelled("protocol", all.firmware.protocol, colour) +
                labelled("extensions", extensions_text(all), colour);
        if (all.firmware == model::FirmwareInfo())
            text += labelled("firmware", "none: it is no board, but takes part as boards do", colour);
        text += labelled("link", link_text(all.link), colour);
        const auto agent = all.agent.client + (all.agent.host.empty() ? "" : " on " + all.agent.host) +
                           (all.agent.version.empty() ? "" : ", version " + all.agent.version);
        text += labelled("agent", agent, colour) +
                labelled("session", all.session + ", announcement " + std::to_string(all.seq), colour);
        text += labelled("lease", std::to_string(all.lease) + " s", colour);
        if (all.on_demand) text += labelled("reports", on_demand_text(*all.on_demand), colour);
        for (const auto& [key, value] : all.labels.labels)
            text += labelled("label", key + "=" + value, colour);
        for (const auto& warning : all.warnings)
            text += labelled("WARNING", warning, colour, Colour::kRed);
        if (!all.labels_fault.empty())
            text += labelled("LABELS", "cannot be read: " + all.labels_fault, colour, Colour::kRed);
        if (const auto pins = pins_text(all, width, colour); !pins.empty()) text += "\n" + pins;
    }
    if (board.description) {
        for (const auto& service : board.description->services) {
            const auto model = bus::model_of(service, models);
            text += "\n" + service_text(item.board, service, board.description->labels.service(service.name),
                                        model.get(), width, colour, known);
        }
    } else {
        for (const auto& service : item.services)
            text +=
                "\n" + painted(for_terminal(item.board + "/" + service.name), Colour::kBold, colour) + "\n";
    }
    return text;
}

}  // namespace asip::cli
