// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/model/model_set.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "cli/generate/generate.hpp"
#include "cli/generate/render.hpp"

namespace asip::generate {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxServices = 15;
constexpr int kMaxPin = 99;

/// `servo=9,10`, as it was written.
struct Wanted {
    std::string name;
    std::vector<std::string> pins;
};

const json& table() {
    static const json rows = json::parse(template_text("services.json"));
    return rows;
}

std::vector<std::string> known_names() {
    std::vector<std::string> names;
    for (const auto& row : table())
        for (const auto& name : row["names"])
            names.push_back(name);
    return names;
}

/// `12`, `A0`, `a0`, as a sketch has it; empty: it is none.
std::string pin_of(std::string text) {
    if (text.size() > 1 && text[0] == 'a') text[0] = 'A';
    const auto digits = std::string_view(text).substr(text.starts_with('A') ? 1 : 0);
    const bool number =
        !digits.empty() && digits.size() <= 2 && (digits[0] != '0' || digits.size() == 1) &&
        std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); });
    return number && std::stoi(std::string(digits)) <= kMaxPin ? text : std::string();
}

Expected<Wanted> read_wanted(const std::string& word) {
    const auto equals = word.find('=');
    Wanted wanted{word.substr(0, equals), {}};
    for (std::size_t at = equals; at != std::string::npos;) {
        const auto end = word.find(',', at + 1);
        const auto text = word.substr(at + 1, end - at - 1);
        const auto pin = pin_of(text);
        if (pin.empty())
            return fail(fmt::format("{}: \"{}\" is no pin; write 7 or A0", text::printable(wanted.name, 40),
                                    text::printable(text, 40)));
        wanted.pins.push_back(pin);
        at = end;
    }
    return wanted;
}

Expected<const json*> find_row(const std::string& name) {
    for (const auto& row : table())
        if (std::find(row["names"].begin(), row["names"].end(), json(name)) != row["names"].end())
            return &row;
    std::vector<std::string> services;
    for (const auto& row : table())
        services.push_back(row["names"][0]);
    return fail(fmt::format("no service is called \"{}\"{}; known are {}", text::printable(name, 40),
                            text::did_you_mean(name, known_names()), fmt::join(services, ", ")));
}

/// What is wrong with the number of pins; empty: nothing.
std::string pins_fault(const json& row, const Wanted& wanted) {
    if (!row.contains("pins"))
        return wanted.pins.empty() ? std::string()
                                   : fmt::format("{} takes no pins: its chip is on {}", wanted.name,
                                                 row["where"].get<std::string>());
    const auto& pins = row["pins"];
    const auto count = wanted.pins.size();
    if (count >= pins["least"] && count <= pins["most"] && count % pins.value("each", 1) == 0) return {};
    return fmt::format("{} takes {}, as {}={}", wanted.name, row["where"].get<std::string>(), wanted.name,
                       pins["example"].get<std::string>());
}

std::string service_of(const json& row) {
    return row.value("service", row["names"][0].get<std::string>());
}

class SketchOfServices {
  public:
    explicit SketchOfServices(const std::string& sketch) : view_({{"sketch", sketch}}) {
        headers_.insert("AsipFastSerial.h");
    }

    Expected<void> add(const json& row, const Wanted& wanted) {
        if (auto fault = pins_fault(row, wanted); !fault.empty()) return fail(std::move(fault));
        const auto model = model::ModelSet::standard().find(service_of(row));
        if (const auto [other, added] = letters_.emplace(model->id, wanted.name); !added)
            return fail(fmt::format("{} and {} cannot be on one board: both have the letter {} on its line",
                                    other->second, wanted.name, model->id));
        json each = json::array();
        for (const auto& pin : wanted.pins) {
            const auto [other, added] = pins_.emplace(pin, &row);
            const bool shared = !added && is_shared(*other->second) && is_shared(row);
            if (!added && !shared) return fail(fmt::format("pin {} is given twice", pin));
            each.push_back({{"pin", pin}, {"first", each.empty()}});
        }
        const auto pins = fmt::format("{}", fmt::join(wanted.pins, ", "));
        for (const auto& line : row["lines"]) {
            json text = {{"line", render(line.get<std::string>(), {{"pins", pins}, {"each", each}})}};
            if (std::find(lines_.begin(), lines_.end(), text) == lines_.end())
                lines_.push_back(std::move(text));
        }
        headers_.insert(row["header"]);
        services_.push_back(
            {{"name", wanted.name},
             {"object", row["object"]},
             {"place", row["where"].get<std::string>() + (pins.empty() ? "" : " (" + pins + ")")}});
        return {};
    }

    std::string text() {
        for (const auto& header : headers_)
            view_["headers"].push_back({{"header", header}});
        view_["lines"] = lines_;
        view_["services"] = services_;
        return render(template_text("services.ino"), view_);
    }

  private:
    static bool is_shared(const json& row) { return row["pins"].value("shared", false); }

    json view_, lines_ = json::array(), services_ = json::array();
    std::set<std::string> headers_;
    std::map<char, std::string> letters_;
    std::map<std::string, const json*> pins_;
};

}  // namespace

Files services_sketch(const std::vector<std::string>& services, const std::string& sketch) {
    if (services.size() > kMaxServices)
        return fail(fmt::format("{} services are too many: a board has {} beside its pins", services.size(),
                                kMaxServices));
    SketchOfServices made(sketch);
    for (const auto& word : services) {
        const auto wanted = read_wanted(word);
        if (!wanted) return fail(wanted.error());
        const auto row = find_row(wanted->name);
        if (!row) return fail(row.error());
        if (const auto added = made.add(**row, *wanted); !added) return fail(added.error());
    }
    return std::vector<GeneratedFile>{{sketch + ".ino", made.text()}};
}

}  // namespace asip::generate
