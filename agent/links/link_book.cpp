// SPDX-License-Identifier: Apache-2.0
#include "agent/links/link_book.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/model/command_encoder.hpp"
#include "asip/model/json.hpp"
#include "asip/property/value.hpp"
#include "asip/text/wall_time.hpp"

namespace asip::agent {
namespace {

using links::Link;
using links::Order;
using nlohmann::json;
using program::log::Level;
using property::Property;

constexpr std::size_t kMaxCauseBytes = 200;

}  // namespace

LinkBook::LinkBook(World world, const Random& random)
    : world_(std::move(world)),
      sources_(world_.board.topics, world_.user, "links-" + random_hex(random, 8), random),
      rules_({.value = [this](const std::string& id) -> std::optional<json> {
                  const auto& properties = world_.values.known().properties();
                  const auto* property = target(id);
                  if (property == nullptr) return std::nullopt;
                  auto known =
                      world_.values.known().known(static_cast<std::size_t>(property - properties.data()));
                  return known.how == property::How::kNone ? std::nullopt
                                                           : std::optional(std::move(known.value));
              },
              .ready = world_.ready,
              .second_of_day = world_.second_of_day,
              .dangerous = [this](const Link& link) { return is_held(link); }}) {}

const Property* LinkBook::target(std::string_view id) const {
    return links::find(world_.values.known().properties(), id);
}

void LinkBook::load(LinkFiles::Loaded loaded, bool stopped, Time now, Effects& out) {
    for (auto& [name, why] : loaded.faults) {
        out.log(Level::kError, "a link cannot be read; the others are used", {{"why", why}});
        set_aside_.push_back(std::move(name));
    }
    for (auto& link : loaded.links) {
        written_[link.link.name] = to_text(link);
        rules_.set(std::move(link.link), std::move(link.kept), now);
    }
    if (stopped) rules_.stopped(true);
    use_sources(now);
    if (something_to_show()) show_at_ = now;
}

bool LinkBook::something_to_show() const {
    return !rules_.links().empty() || !set_aside_.empty();
}

// --- sources

std::set<std::string> LinkBook::filters() const {
    return sources_.filters();
}

void LinkBook::connected(Time now) {
    if (something_to_show() || shown_at_) show_at_ = now;
}

void LinkBook::hear(const links::Sources::Tolds& told, Time now) {
    using Kind = links::Told::Kind;
    for (const auto& each : told) {
        if (each.kind == Kind::kValue) rules_.source(each.board, each.id, each.value, now);
        if (each.kind == Kind::kAct && !(old_until_ && now < *old_until_))
            rules_.act(each.board, each.id, each.act, now);
        if (each.kind != Kind::kPresent) continue;
        rules_.present(each.board, each.is, now);
        show_soon(now + kBetweenShown);
    }
}

// --- the board

void LinkBook::executed(const std::vector<std::string>& targets, const std::string& link) {
    for (const auto& each : targets)
        rules_.executed(each, link);
}

void LinkBook::finished(const std::string& link, const bus::Reply& reply) {
    const auto found = open_.find(link);
    if (found == open_.end()) return;
    if (!reply.succeeded() && found->second.failure.empty())
        found->second.failure = reply.error.empty() ? "no sign that the board executed it" : reply.error;
    if (--found->second.commands > 0) return;
    const auto open = open_.extract(found).mapped();
    for (auto left = open.orders; left > 0; --left)
        rules_.finished(link, open.failure.empty(), open.failure);
}

std::string LinkBook::safe_line(const Link& link) const {
    std::vector<property::Request> requests;
    if (!link.command.is_null())
        requests.push_back({link.target, model::dump_json(link.command)});
    else if (const auto* property = target(link.target)) {
        // Which value does not matter: what undoes it is the same.
        for (const auto& value : {json(false), json(property->min.value_or(0))})
            if (requests.empty())
                requests = property::requests_for(*property, property::value_of_control(*property, value));
    }
    if (requests.empty()) return {};
    const auto* service = world_.board.services.find(requests.back().service);
    const auto object = model::parse_json(requests.back().payload);
    if (service == nullptr || !service->model || !object) return {};
    const auto encoded = model::encode_control_json(service->model.get(), service->letter, *object);
    return encoded ? encoded->safe : std::string();
}

/// Whether the model says that it moves something: `hold`.
bool LinkBook::is_held(const Link& link) const {
    const auto* property = target(link.target);
    const auto* service = world_.board.services.find(property != nullptr ? property->service : link.target);
    if (service == nullptr || !service->model) return false;
    const auto command = link.command.is_null()
                             ? property != nullptr && property->write ? property->write->command : ""
                             : link.command.begin().key();
    const auto source = json::parse(service->model->source, nullptr, false);
    return source.value("commands", json::object()).value(command, json::object()).value("hold", false);
}

Command LinkBook::command(const Order& order, const std::string& service, std::string payload,
                          Time now) const {
    const auto& board = world_.board;
    mqtt::Message message;
    message.topic =
        service.empty() ? board.topics.board_in(board.name) : board.topics.service_in(board.name, service);
    message.payload = std::move(payload);
    Command command;
    command.topic = message.topic;
    command.service = service;
    command.payload = message.payload;
    if (auto envelope = bus::open_envelope(message)) command.envelope = std::move(*envelope);
    command.envelope.reply.by =
        ("link " + order.link + ", because " + order.because).substr(0, kMaxCauseBytes);
    command.arrival.received = now;
    command.link = order.link;
    return command;
}

void LinkBook::add_commands(const Order& order, Time now, std::vector<Command>& commands) {
    const auto& link = rules_.links().at(order.link).link;
    std::vector<property::Request> requests;
    auto kind = order.kind;
    const auto line = kind == Order::Kind::kSafe ? safe_line(link) : std::string();
    if (!line.empty())
        requests.push_back({"", line});
    else if (kind == Order::Kind::kCommand)
        requests.push_back({link.target, model::dump_json(link.command)});
    else if (const auto* property = target(link.target))
        requests = property::requests_for(
            *property,
            property::value_of_control(*property, kind == Order::Kind::kSafe ? json(false) : order.value));
    if (requests.empty())
        return rules_.finished(order.link, false, link.target + " cannot be " + links::words_of(order.value));
    auto& open = open_[order.link];
    ++open.orders;
    open.commands += requests.size();
    for (auto& request : requests)
        commands.push_back(command(order, request.service, std::move(request.payload), now));
}

std::vector<Command> LinkBook::run(Time now) {
    hear(sources_.tick(now), now);
    std::vector<Command> commands;
    for (const auto& order : rules_.run(now))
        add_commands(order, now, commands);
    return commands;
}

// --- what is told

std::string LinkBook::document() const {
    auto shown = json::array();
    for (const auto& [name, entry] : rules_.links()) {
        auto object = links::to_json(entry.link);
        if (entry.kept.suspended) object["suspended"] = true;
        if (!entry.cause.empty()) object["last"] = entry.cause.substr(0, kMaxCauseBytes);
        if (const auto at = caused_.find(name); at != caused_.end()) object["at"] = at->second;
        const auto* properties = sources_.properties(entry.link.board);
        std::string fault;
        if (properties != nullptr)
            fault = links::source_fault(entry.link, *properties);
        else if (!sources_.is_present(entry.link.board))
            fault = entry.link.board + " is not heard";
        if (fault.empty() && !world_.values.known().properties().empty())
            fault = links::target_fault(entry.link, world_.values.known().properties());
        if (!fault.empty()) object["fault"] = std::move(fault);
        shown.push_back(std::move(object));
    }
    json document{{"version", 1}, {"board", world_.board.name}, {"links", std::move(shown)}};
    if (!set_aside_.empty()) document["set_aside"] = set_aside_;
    return model::dump_json(document);
}

void LinkBook::show_soon(Time now) {
    if (!show_at_) show_at_ = shown_at_ ? std::max(now, *shown_at_ + kBetweenShown) : now;
}

void LinkBook::tell(bool may_publish, Time now, Effects& out) {
    for (const auto& name : rules_.take_changed()) {
        show_soon(now);
        const auto found = rules_.links().find(name);
        if (found == rules_.links().end()) {
            for (auto* each : {&written_, &caused_, &causes_})
                each->erase(name);
            write_at_.erase(name);
            wrote_.erase(name);
            continue;
        }
        const auto& entry = found->second;
        if (std::exchange(causes_[name], entry.cause) != entry.cause)
            caused_[name] = text::iso_time(text::wall_now());
        const bool paced = entry.kept.seen.is_number() && !entry.kept.suspended;
        const auto wrote = wrote_.find(name);
        const auto at =
            wrote == wrote_.end() ? now : wrote->second + (paced ? kBetweenWrites : kBetweenFlips);
        const auto due = write_at_.try_emplace(name, at).first;
        due->second = std::min(due->second, at);
    }
    for (auto each = write_at_.begin(); each != write_at_.end();) {
        if (now < each->second || unwritten_ >= kMaxUnwritten) {
            ++each;
            continue;
        }
        const auto& entry = rules_.links().at(each->first);
        KeptLink link{entry.link, entry.kept};
        auto text = to_text(link);
        if (auto& written = written_[each->first]; written != text) {
            written = text;
            wrote_[each->first] = now;
            ++unwritten_;
            out.keep_links.push_back({each->first, std::move(text), 0});
        }
        each = write_at_.erase(each);
    }
    if (!may_publish) return;
    for (auto& demand : sources_.demands(now)) {
        const auto topic = world_.board.topics.parse(demand.topic);
        if (topic && topic->board == world_.board.name)
            own_demands_.push_back(std::move(demand));
        else
            out.publish.push_back({std::move(demand), mqtt::Priority::kContext});
    }
    if (!show_at_ || now < *show_at_) return;
    show_at_.reset();
    shown_at_ = now;
    out.publish.push_back({member::retained(world_.board.topics.links(world_.board.name),
                                            something_to_show() ? document() : std::string()),
                           mqtt::Priority::kAnnouncement});
}

std::optional<Time> LinkBook::next_deadline(bool may_publish) const {
    if (!any()) return std::nullopt;  // a source that is no longer one is lost unnoticed
    auto first = rules_.next_deadline();
    const auto take = [&first](const std::optional<Time>& when) {
        if (when && (!first || *when < *first)) first = when;
    };
    take(sources_.next_deadline(may_publish));
    if (may_publish) take(show_at_);
    if (unwritten_ < kMaxUnwritten)
        for (const auto& [name, at] : write_at_)
            take(at);
    return first;
}

}  // namespace asip::agent
