#include "cli/context_event.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asip/model/json.hpp"
#include "asip/protocol/body.hpp"
#include "asip/text/duration.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/wall_time.hpp"
#include "cli/bus_session.hpp"
#include "cli/text/table.hpp"
#include "cli/text/width.hpp"

namespace asip::cli {
namespace {

constexpr std::array<std::string_view, 8> kNames{"time",  "board", "service", "where",
                                                 "topic", "kind",  "payload", "age"};

std::string_view kind_text(ContextEvent::Kind kind) {
    switch (kind) {
        case ContextEvent::Kind::kValue:
            return "event";
        case ContextEvent::Kind::kError:
            return "error";
        case ContextEvent::Kind::kRaw:
            break;
    }
    return "line";
}

std::string level(const std::string& name) {
    const bool pattern = name.empty() || name.find_first_of("*?") != std::string::npos;
    return pattern ? "+" : name;
}

std::string data_at(const std::string& payload, std::string_view path) {
    const auto document = model::parse_json(payload);
    if (!document) return {};
    const nlohmann::json* value = &*document;
    while (!path.empty()) {
        const auto end = std::min(path.find('.'), path.size());
        const std::string key(path.substr(0, end));
        const auto index = protocol::parse_integer(key);
        if (value->is_object() && value->contains(key)) {
            value = &(*value)[key];
        } else if (value->is_array() && index && *index >= 0 &&
                   static_cast<std::size_t>(*index) < value->size()) {
            value = &(*value)[static_cast<std::size_t>(*index)];
        } else {
            return {};
        }
        path.remove_prefix(std::min(end + 1, path.size()));
    }
    return value->is_string() ? value->get<std::string>() : model::dump_json(*value);
}

std::string age_text(const ContextEvent& event) {
    return event.age ? "+" + text::duration_text(*event.age) : event.retained ? "retained" : "first";
}

}  // namespace

std::optional<ContextEvent> context_event(const bus::Topics& topics, const std::string& topic,
                                          std::string payload) {
    const auto ref = topics.parse(topic);
    if (!ref) return std::nullopt;
    ContextEvent event;
    switch (ref->kind) {
        case bus::TopicKind::kServiceOut:
            event.kind = ContextEvent::Kind::kValue;
            break;
        case bus::TopicKind::kServiceError:
            event.kind = ContextEvent::Kind::kError;
            break;
        case bus::TopicKind::kBoardOut:
            event.kind = ContextEvent::Kind::kRaw;
            break;
        default:
            return std::nullopt;
    }
    event.board = ref->board;
    event.service = ref->service;
    event.topic = topic;
    event.payload = std::move(payload);
    return event;
}

std::vector<std::string> context_filters(const bus::Topics& topics, const std::vector<Target>& targets,
                                         bool raw) {
    std::vector<std::string> all;
    for (const auto& target : targets) {
        const auto board = level(target.board);
        if (raw) {
            all.push_back(topics.board_out(board));
        } else {
            all.push_back(topics.service_out(board, level(target.service)));
            all.push_back(topics.service_error(board, level(target.service)));
        }
    }
    std::vector<std::string> result;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool covered = [&] {
            for (std::size_t j = 0; j < all.size(); ++j) {
                if (i == j || !topic_matches(all[j], all[i])) continue;
                if (all[i] != all[j] || j < i) return true;
            }
            return false;
        }();
        if (!covered) result.push_back(all[i]);
    }
    return result;
}

std::string event_text(const ContextEvent& event, bool with_time, bool with_age, bool colour) {
    std::string text;
    if (with_time) text += painted(text::iso_time(event.time), Colour::kDim, colour) + "  ";
    text += painted(event.where(), Colour::kCyan, colour) + "  ";
    if (with_age) text += painted(fmt::format("{:>8}", age_text(event)), Colour::kDim, colour) + "  ";
    const bool error = event.kind == ContextEvent::Kind::kError;
    return text + painted((error ? "error " : "") + printable(event.payload),
                          error ? Colour::kRed : Colour::kNone, colour);
}

std::string event_json(const ContextEvent& event) {
    nlohmann::json object{{"time", text::iso_time(event.time)}, {"board", event.board}};
    if (!event.service.empty()) object["service"] = event.service;
    auto payload = event.kind == ContextEvent::Kind::kRaw ? tl::unexpected<std::string>("")
                                                          : model::parse_json(event.payload);
    object[std::string(kind_text(event.kind))] =
        payload ? std::move(*payload) : nlohmann::json(event.payload);
    if (event.age) object["age"] = std::round(event.age->count() * 1e6) / 1e6;
    if (event.retained) object["retained"] = true;
    return model::dump_json(object);
}

std::string event_value(const ContextEvent& event, std::string_view name) {
    if (name == "time") return text::iso_time(event.time);
    if (name == "board") return event.board;
    if (name == "service") return event.service;
    if (name == "where") return event.where();
    if (name == "topic") return event.topic;
    if (name == "kind") return std::string(kind_text(event.kind));
    if (name == "payload") return event.payload;
    if (name == "age") return event.age ? fmt::format("{:.6f}", event.age->count()) : "";
    if (name == "data") return event.payload;
    return name.starts_with("data.") ? data_at(event.payload, name.substr(5)) : std::string();
}

Expected<void> check_event_template(const LineTemplate& line) {
    std::vector<std::string> known(kNames.begin(), kNames.end());
    for (const auto& name : line.names()) {
        if (name == "data" || name.starts_with("data.") ||
            std::find(known.begin(), known.end(), name) != known.end())
            continue;
        std::string all;
        for (const auto& one : known)
            all += one + ", ";
        return fail("format: no {" + name + "}" + text::did_you_mean(name, known) + "; there are " + all +
                    "data.PATH");
    }
    return {};
}

}  // namespace asip::cli
