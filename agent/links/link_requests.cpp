// SPDX-License-Identifier: Apache-2.0
// Requests to set, change and remove links.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "agent/links/link_book.hpp"
#include "asip/bus/request/agent_requests.hpp"
#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::agent {

using links::Link;
using nlohmann::json;
using program::log::Level;

std::string LinkBook::why_not(const Link& link) const {
    const auto& board = world_.board;
    if (link.command.is_null()) {
        const auto& properties = world_.values.known().properties();
        if (properties.empty()) return "the board has not been heard: nothing is known of its properties";
        if (auto fault = links::target_fault(link, properties); !fault.empty()) return fault;
    } else {
        const auto* service = board.services.find(link.target);
        std::vector<std::string> names;
        for (const auto& each : board.services.entries())
            names.push_back(each.name);
        if (service == nullptr)
            return "the board has no service " + text::printable(link.target, 64) +
                   text::did_you_mean(link.target, names);
        const auto line = model::encode_control_json(service->model.get(), service->letter, link.command);
        if (!line) return line.error();
    }
    const bool own = link.board == board.name;
    if (const auto* properties = own ? &world_.values.known().properties() : sources_.properties(link.board))
        if (auto fault = links::source_fault(link, *properties); !fault.empty()) return fault;
    std::vector<links::Ends> ends;
    for (const auto& [name, entry] : rules_.links())
        if (name != link.name)
            ends.emplace_back(entry.link.board + "/" + entry.link.source,
                              board.name + "/" + entry.link.target);
    const auto circle = links::circle(ends, {link.board + "/" + link.source, board.name + "/" + link.target});
    return circle.empty() ? std::string() : "that would be a circle: " + circle;
}

bool LinkBook::request(const LinkRequest& request, Time now, Effects& out) {
    const auto refuse = [&](std::string_view reason, std::string why) {
        if (refusals_.take(now))
            out.log(request.reply().wanted() ? Level::kDebug : Level::kWarning, "link refused",
                    {{"why", why}, {"user", request.user}});
        if (auto message =
                bus::reply_message(request.reply(), bus::Reply::refused(std::string(reason), std::move(why))))
            out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
        return false;
    };
    const auto& object = request.envelope.object;
    if (!request.fault.empty()) return refuse(bus::kRefusedInvalid, request.fault);
    if (now > request.deadline()) return refuse(bus::kRefusedDeadline, "it came too late; send it again");
    if (asked_.size() >= kMaxUnwritten)
        return refuse(bus::kRefusedQueueFull, "the agent is still writing what was asked for before");
    std::string why =
        "write {\"set\":{...}}, {\"remove\":\"NAME\"}, {\"enable\":\"NAME\"} or {\"disable\":\"NAME\"}";
    if (object.is_object() && object.size() == 1) {
        const auto& what = object.begin().key();
        const auto& value = object.begin().value();
        if (what == "set" && request.stopped)
            return refuse(bus::kRefusedStopped, "the board was stopped while it waited; no link was made");
        if (what == "set")
            why = set(request, value, now, out);
        else if (what == "remove" || what == "enable" || what == "disable")
            why = change(request, what, value, now, out);
    }
    if (!why.empty()) return refuse(bus::kRefusedInvalid, std::move(why));
    show_soon(now);
    return true;
}

std::vector<std::string> LinkBook::names_of(const std::string& user) const {
    std::vector<std::string> names;
    for (const auto& [name, entry] : rules_.links())
        if (entry.link.user == user) names.push_back(name);
    return names;
}

std::string LinkBook::set(const LinkRequest& request, const json& wanted, Time now, Effects& out) {
    auto owned = wanted;
    if (owned.is_object()) owned["user"] = request.user;
    auto link = links::read_link(owned);
    if (!link) return link.error();
    if (auto why = why_not(*link); !why.empty()) return why;
    Asked asked{request.reply(), link->name, {}, {}};
    if (const auto found = rules_.links().find(link->name); found != rules_.links().end()) {
        if (found->second.link.user != link->user)
            return "link " + link->name + " is one of " + found->second.link.user + ": take another name";
        asked.before = KeptLink{found->second.link, found->second.kept};
    } else if (rules_.links().size() >= links::kMaxLinks) {
        return "the board has " + std::to_string(links::kMaxLinks) + " links already";
    } else if (names_of(link->user).size() >= links::kMaxOfAUser && link->user != bus::user_level("")) {
        return "the board has " + std::to_string(links::kMaxOfAUser) + " links of " + link->user +
               " already: remove one first";
    }
    asked.answer = model::dump_json(links::to_json(*link));
    // The same again, or a repeated message: who set the target meanwhile goes on to win.
    if (asked.before && asked.before->link == *link) {
        const auto text = to_text(*asked.before);
        begin(std::move(asked), text, out);
        return {};
    }
    KeptLink kept{std::move(*link), {}};
    const auto text = to_text(kept);
    put(std::move(kept), now);
    begin(std::move(asked), text, out);
    return {};
}

std::string LinkBook::change(const LinkRequest& request, std::string_view what, const json& name, Time now,
                             Effects& out) {
    if (!name.is_string()) return "the name of a link must be a text";
    auto names = names_of(request.user);
    const bool all = name == json("*");
    if (!all) {
        const auto found = rules_.links().find(name.get<std::string>());
        if (found == rules_.links().end())
            return "there is no link " + text::printable(name.get<std::string>(), 64) +
                   text::did_you_mean(name.get<std::string>(), names);
        if (found->second.link.user != request.user)
            return "link " + found->first + " is one of " + found->second.link.user;
        names = {found->first};
    }
    if (names.empty())
        if (auto message =
                bus::reply_message(request.reply(), bus::Reply::ok(std::string(bus::kProofKept), "0")))
            out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
    for (const auto& each : names) {
        const auto& entry = rules_.links().at(each);
        Asked asked{each == names.back() ? request.reply() : bus::ReplyTo(), each,
                    std::to_string(names.size()), KeptLink{entry.link, entry.kept}};
        if (what != "remove") {
            rules_.enable(each, what == "enable");
            begin(std::move(asked), to_text({entry.link, entry.kept}), out);
            continue;
        }
        rules_.remove(each);
        begin(std::move(asked), {}, out);
    }
    use_sources(now);
    return {};
}

void LinkBook::begin(Asked asked, const std::string& text, Effects& out) {
    written_[asked.name] = text;
    out.keep_links.push_back({asked.name, text, ++ticket_});
    asked_.emplace(ticket_, std::move(asked));
}

void LinkBook::kept(std::uint64_t ticket, const Expected<void>& result, Time now, Effects& out) {
    const auto found = asked_.find(ticket);
    if (found == asked_.end()) {
        if (unwritten_ > 0) --unwritten_;
        if (!result)
            out.log(Level::kError, "what links remember could not be kept", {{"why", result.error()}});
        return;
    }
    const auto asked = asked_.extract(found).mapped();
    auto reply = bus::Reply::ok(std::string(bus::kProofKept), asked.answer);
    if (!result) {
        reply = bus::Reply::refused(std::string(bus::kRefusedNotKept), result.error());
        out.log(Level::kError, "a link could not be kept", {{"link", asked.name}, {"why", result.error()}});
        const auto later = std::find_if(asked_.begin(), asked_.end(),
                                        [&](const auto& each) { return each.second.name == asked.name; });
        if (later != asked_.end())
            later->second.before = asked.before;  // it decides
        else if (asked.before)
            put(*asked.before, now);
        else
            rules_.remove(asked.name), use_sources(now);
    }
    if (auto message = bus::reply_message(asked.reply, reply))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
}

void LinkBook::put(KeptLink link, Time now) {
    const links::Sources::Id source{link.link.board, link.link.source};
    rules_.set(std::move(link.link), std::move(link.kept), now);
    use_sources(now);
    if (const auto value = sources_.value(source)) rules_.source(source.first, source.second, value, now);
}

void LinkBook::use_sources(Time now) {
    std::set<links::Sources::Id> sources;
    for (const auto& [name, entry] : rules_.links())
        sources.emplace(entry.link.board, entry.link.source);
    hear(sources_.want(sources, now), now);
}

}  // namespace asip::agent
