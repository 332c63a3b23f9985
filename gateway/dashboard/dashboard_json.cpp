// SPDX-License-Identifier: Apache-2.0
// A dashboard as JSON: what is read, with each fault as a sentence, and what is written.
#include <algorithm>
#include <array>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>

#include "asip/bus/registry/label_selector.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"
#include "asip/text/wall_time.hpp"
#include "gateway/dashboard/dashboard.hpp"

namespace asip::gateway {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, 8> kKinds{"value", "plot", "switch", "slider",
                                                 "lamp",  "stop", "gauge",  "text"};
constexpr std::array<std::string_view, 3> kSizes{"small", "wide", "large"};
constexpr std::array<std::string_view, 9> kMembers{"id",       "kind",   "title", "size", "board",
                                                   "property", "labels", "text",  "span"};
constexpr std::size_t kMaxTitle = 100;
constexpr std::size_t kMaxWord = 256;
constexpr std::size_t kMaxText = 1000;
constexpr std::size_t kMaxId = 16;

std::string list_of(const auto& words) {
    std::string text;
    for (const auto word : words)
        text.append(text.empty() ? "" : ", ").append(word);
    return text;
}

/// Reads the members of one widget; the first fault stays.
class Reader {
  public:
    Reader(const json& object, std::string place) : object_(object), place_(std::move(place)) {}

    void fault(const std::string& sentence) {
        if (fault_.empty()) fault_ = place_ + ": " + sentence;
    }
    const std::string& fault() const { return fault_; }

    std::string word(const char* name, std::size_t max = kMaxWord) {
        const auto found = object_.find(name);
        if (found == object_.end()) return {};
        if (!found->is_string() || found->get_ref<const std::string&>().size() > max) {
            fault(std::string(name) + " must be a text of at most " + std::to_string(max) + " bytes");
            return {};
        }
        return found->get<std::string>();
    }
    std::string needed(const char* name, std::size_t max = kMaxWord) {
        auto text = word(name, max);
        if (text.empty()) fault(std::string(name) + " is missing");
        return text;
    }
    std::string name_of(const char* member) {
        auto text = needed(member);
        if (!text.empty() && !model::valid_name(text))
            fault(std::string(member) + ": \"" + text::printable(text) + "\" is not a name");
        return text;
    }
    std::string labels() {
        auto text = word("labels");
        if (text.empty()) return {};
        if (const auto parsed = bus::LabelSelector::parse(text); !parsed) fault("labels: " + parsed.error());
        if (object_.contains("board")) fault("board and labels exclude each other");
        return text;
    }
    std::string choice(const char* name, const auto& choices) {
        auto text = word(name);
        if (!text.empty() && std::find(choices.begin(), choices.end(), text) == choices.end())
            fault(std::string(name) + ": \"" + text::printable(text) + "\" is none of " + list_of(choices) +
                  text::did_you_mean(text, choices));
        return text;
    }
    void no_others() {
        for (const auto& [name, value] : object_.items())
            if (std::find(kMembers.begin(), kMembers.end(), name) == kMembers.end())
                fault("there is no member \"" + text::printable(name) + "\"" +
                      text::did_you_mean(name, kMembers));
    }

  private:
    const json& object_;
    std::string place_;
    std::string fault_;
};

bool valid_id(std::string_view id) {
    return !id.empty() && id.size() <= kMaxId && std::all_of(id.begin(), id.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_';
    });
}

Expected<Widget> read_widget(const json& object, const std::string& place) {
    if (!object.is_object()) return fail(place + ": must be an object");
    Reader reader(object, place);
    reader.no_others();
    Widget widget;
    widget.id = reader.word("id", kMaxId);
    if (!widget.id.empty() && !valid_id(widget.id)) reader.fault("id must be 1 to 16 of A-Z a-z 0-9 _ -");
    const auto kind = reader.choice("kind", kKinds);
    if (kind.empty()) reader.fault("kind is missing: " + list_of(kKinds));
    if (!reader.fault().empty()) return fail(reader.fault());
    widget.kind = static_cast<Widget::Kind>(std::find(kKinds.begin(), kKinds.end(), kind) - kKinds.begin());
    widget.title = reader.word("title", kMaxTitle);
    widget.size = reader.choice("size", kSizes);
    widget.span = reader.choice("span", Widget::kSpans);
    if (!widget.span.empty() && widget.kind != Widget::Kind::kPlot) reader.fault("span is that of a plot");
    if (widget.kind == Widget::Kind::kText) {
        widget.text = reader.needed("text", kMaxText);
    } else if (widget.kind != Widget::Kind::kStop) {
        widget.labels = reader.labels();
        if (widget.labels.empty()) widget.board = reader.name_of("board");
        widget.property = reader.needed("property");
        if (!widget.property.empty() && !model::valid_name(widget.service()))
            reader.fault("property: \"" + text::printable(widget.property) +
                         "\" is no id, such as servo/0/angle");
    }
    if (!reader.fault().empty()) return fail(reader.fault());
    return widget;
}

json widget_json(const Widget& widget) {
    json object{{"id", widget.id}, {"kind", kKinds[static_cast<std::size_t>(widget.kind)]}};
    const auto add = [&](const char* name, const std::string& text) {
        if (!text.empty()) object[name] = text;
    };
    add("title", widget.title);
    add("size", widget.size);
    add("board", widget.board);
    add("property", widget.property);
    add("labels", widget.labels);
    add("text", widget.text);
    add("span", widget.span);
    return object;
}

/// Gives an id to those without one; an id that stands twice is a fault.
Expected<void> complete_ids(std::vector<Widget>& widgets) {
    std::set<std::string> ids;
    for (const auto& widget : widgets)
        if (!widget.id.empty() && !ids.insert(widget.id).second)
            return fail("widgets: two have the id " + widget.id);
    int next = 0;
    for (auto& widget : widgets) {
        while (widget.id.empty()) {
            auto id = "w" + std::to_string(++next);
            if (ids.insert(id).second) widget.id = std::move(id);
        }
    }
    return {};
}

Expected<Dashboard> read_dashboard(const json& object, bool kept) {
    if (!object.is_object()) return fail("a dashboard must be an object with title and widgets");
    for (const auto& [name, value] : object.items()) {
        const bool known = name == "title" || name == "widgets" || name == "name" || name == "by" ||
                           name == "changed" || name == "links";
        if (!known)
            return fail("there is no member \"" + text::printable(name) + "\": only title and widgets");
    }
    Dashboard dashboard;
    Reader reader(object, "dashboard");
    dashboard.title = reader.word("title", kMaxTitle);
    if (!reader.fault().empty()) return fail(reader.fault());
    const auto widgets = object.find("widgets");
    if (widgets == object.end() || !widgets->is_array()) return fail("widgets must be an array");
    if (widgets->size() > Dashboard::kMaxWidgets)
        return fail("widgets: at most " + std::to_string(Dashboard::kMaxWidgets) +
                    "; make another dashboard for the others");
    for (std::size_t i = 0; i < widgets->size(); ++i) {
        auto widget = read_widget((*widgets)[i], "widget " + std::to_string(i + 1));
        if (!widget) return Unexpected<std::string>(widget.error());
        dashboard.widgets.push_back(std::move(*widget));
    }
    if (auto ids = complete_ids(dashboard.widgets); !ids) return Unexpected<std::string>(ids.error());
    if (kept) {
        dashboard.by = reader.word("by", kMaxTitle * 2);
        dashboard.changed = reader.word("changed");
    }
    return dashboard;
}

std::optional<DashboardLink> read_link(const json& object) {
    if (!object.is_object()) return std::nullopt;
    Reader reader(object, "link");
    DashboardLink link{reader.name_of("name"),
                       reader.needed("hash"),
                       reader.word("by", kMaxTitle * 2),
                       reader.word("maker"),
                       object.value("control", json(false)) == json(true),
                       {}};
    if (const auto until = reader.word("until"); !until.empty()) {
        link.until = text::parse_iso_time(until);
        if (!link.until) return std::nullopt;
    }
    return reader.fault().empty() ? std::optional(std::move(link)) : std::nullopt;
}

}  // namespace

Expected<Dashboard> parse_dashboard(std::string_view text) {
    auto object = model::parse_json(text, {.max_bytes = Dashboard::kMaxBytes, .max_depth = 6});
    if (!object) return fail("the body is not JSON: " + object.error());
    return read_dashboard(*object, false);
}

Expected<Dashboard> parse_kept_dashboard(std::string_view text) {
    auto object = model::parse_json(text, {.max_bytes = Dashboard::kMaxKept, .max_depth = 6});
    if (!object) return Unexpected<std::string>(object.error());
    auto dashboard = read_dashboard(*object, true);
    if (!dashboard) return dashboard;
    if (const auto links = object->find("links"); links != object->end() && links->is_array()) {
        for (const auto& each : *links) {
            auto link = read_link(each);
            if (!link || dashboard->links.size() >= Dashboard::kMaxLinks) return fail("links cannot be read");
            dashboard->links.push_back(std::move(*link));
        }
    }
    return dashboard;
}

json to_json(const Dashboard& dashboard) {
    json widgets = json::array();
    for (const auto& widget : dashboard.widgets)
        widgets.push_back(widget_json(widget));
    json object{{"title", dashboard.title}, {"widgets", std::move(widgets)}};
    if (!dashboard.by.empty()) object["by"] = dashboard.by;
    if (!dashboard.changed.empty()) object["changed"] = dashboard.changed;
    return object;
}

std::string kept_text(const Dashboard& dashboard) {
    auto object = to_json(dashboard);
    for (const auto& link : dashboard.links) {
        json item{{"name", link.name},
                  {"hash", link.hash},
                  {"by", link.by},
                  {"maker", link.maker},
                  {"control", link.control}};
        if (link.until) item["until"] = text::iso_time(*link.until);
        object["links"].push_back(std::move(item));
    }
    return model::dump_json(object);
}

}  // namespace asip::gateway
