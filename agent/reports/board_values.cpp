// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/board_values.hpp"

#include <algorithm>

#include "asip/bus/pattern.hpp"
#include "asip/bus/request/reply.hpp"
#include "asip/property/documents.hpp"
#include "asip/property/list.hpp"
#include "asip/protocol/extensions.hpp"
#include "asip/protocol/pin.hpp"
#include "asip/protocol/request.hpp"

namespace asip::agent {
namespace {

using nlohmann::json;
using property::How;

constexpr std::string_view kIo = "io";
constexpr std::string_view kMode = "mode";
constexpr char kModeTag = 'P';
constexpr std::string_view kWrite = "write";
constexpr const char* kLevels = "levels";
constexpr const char* kDigital = "digital";
constexpr std::size_t kMaxQuotas = 1024;

/// The mode that a request sets, and of which pin.
std::optional<std::pair<int, int>> mode_of(const model::ServiceModel& model,
                                           const model::RequestValues& request) {
    if (model.name != kIo || request.command->name != kMode || request.values.size() != 2)
        return std::nullopt;
    return std::pair(request.values[0].get<int>(), request.values[1].get<int>());
}

bool is_input(int mode) {
    const auto known = protocol::pin_mode_from_number(mode);
    return known && protocol::is_digital_input(*known);
}

}  // namespace

std::optional<BoardValues::Request> BoardValues::read(std::string_view line) const {
    const auto* service = line.size() < 3 ? nullptr : board_.services.find(line[0]);
    if (service == nullptr || !service->model) return std::nullopt;
    auto values = model::request_values(*service->model, line.substr(2));
    if (!values) return std::nullopt;
    return Request{service->model, service->name, std::move(*values)};
}

void BoardValues::queued(session::RequestId id, std::string_view line) {
    // What the others set is looked at once they are executed: they are on the way to the board.
    if (const auto request = line.size() > 2 && line[2] == kModeTag ? read(line) : std::nullopt)
        if (const auto mode = mode_of(*request->model, request->values); mode && is_input(mode->second))
            known_.input_begins(request->service, mode->first);
    requests_.emplace(id, line);
}

std::optional<BoardValues::Request> BoardValues::on_finished(const session::Finished& end, Time now) {
    using session::Ending;
    const auto found = requests_.find(end.id);
    if (found == requests_.end()) return std::nullopt;
    const auto line = requests_.extract(found).mapped();
    if (end.ending == Ending::kNotSent || end.ending == Ending::kBoardError) return std::nullopt;
    auto request = read(line);
    if (request) apply(*request, end.ending == Ending::kTimeout || end.ending == Ending::kDoubt, now);
    return request;
}

bool BoardValues::low_is_on(std::string_view line) const {
    const auto request = read(line);
    if (!request || request->service != kIo || request->values.command->name != kWrite) return false;
    const auto& values = request->values.values;
    return values.size() == 2 && values[1] == json(0) &&
           std::any_of(
               known_.properties().begin(), known_.properties().end(), [&values](const auto& property) {
                   return property.service == kIo && property.write && property.write->command == kWrite &&
                          property.write->arguments.front() == values[0].template get<double>() &&
                          property.choices.at(1).second == 0;
               });
}

std::vector<std::string> BoardValues::set_by(const Request& request) const {
    std::vector<std::string> ids;
    const auto& values = request.values;
    for (const auto& property : known_.properties())
        if (property.service == request.service &&
            std::any_of(property.setters.begin(), property.setters.end(), [&values](const auto& setter) {
                return setter.command == values.command->name &&
                       (!setter.element_at || (*setter.element_at < values.values.size() &&
                                               values.values[*setter.element_at] == json(setter.element)));
            }))
            ids.push_back(property.id);
    return ids;
}

void BoardValues::executed(std::string_view line, Time now) {
    if (const auto request = read(line)) apply(*request, false, now);
}

void BoardValues::apply(const Request& request, bool perhaps, Time now) {
    note(known_.executed(request.service, request.values, perhaps, now), kBetween, now);
    if (const auto mode = mode_of(*request.model, request.values); mode && !perhaps) modes_.push_back(*mode);
}

void BoardValues::modes_told(const std::vector<std::pair<int, int>>& modes, Time now) {
    for (const auto& [pin, mode] : modes)
        if (is_input(mode)) note(known_.input_began(kIo, pin, now), kBetween, now);
}

void BoardValues::reported(const std::string& service, const json& published, Time now) {
    const bool pins = service == kIo && published.is_object();
    // The answer to I,L: the same levels as those of the events.
    if (const auto levels = pins ? published.find(kLevels) : published.end();
        pins && levels != published.end())
        return note(known_.reported(service, {{kDigital, *levels}}, How::kAnswered, now), kBetween, now);
    // Levels are what people wait for; numbers flow.
    note(known_.reported(service, published, How::kReported, now),
         pins && published.contains(kDigital) ? kBetween : kBetweenNumbers, now);
}

void BoardValues::restarted(Time now) {
    forget(now);
}

void BoardValues::identified(Time now) {
    if (std::exchange(away_, false)) forget(now);
}

/// Readers are told even where no value was known: they may have read reports of which no document told.
void BoardValues::forget(Time now) {
    known_.forget(now);
    ++restarts_;
    note(true, kBetween, now);
}

std::vector<std::string> BoardValues::lines_to_learn(const model::Labels& labels) const {
    std::vector<std::string> lines;
    const auto* io = board_.services.find(kIo);
    if (io == nullptr || !io->model || io->model->name != kIo) return lines;
    const auto& modes = board_.session.identity().pin_modes;
    const bool tells = board_.session.identity().extensions.has(protocol::kLevels);
    for (const auto& [pin, commanded] : labels.modes) {
        if (!is_input(commanded) || static_cast<std::size_t>(pin) >= modes.size()) continue;
        const auto present = modes[static_cast<std::size_t>(pin)];
        const bool unused = present == protocol::PinMode::kUnallocated;
        if (unused || (!tells && static_cast<int>(present) == commanded))
            lines.push_back(std::string{io->letter} + ",P," + std::to_string(pin) + "," +
                            std::to_string(commanded));
    }
    if (tells) lines.emplace_back(protocol::kAskLevels);
    return lines;
}

void BoardValues::describe(model::Description description, Time now) {
    description.board = board_.name;  // sentences name it
    auto properties = property::properties_of(description, [this](const model::ServiceInfo& service) {
        const auto* entry = board_.services.find(std::string_view(service.name));
        return entry == nullptr ? nullptr : entry->model;
    });
    if (properties == known_.properties()) return;
    has_contacts_ = std::any_of(properties.begin(), properties.end(), property::is_contact);
    known_.use(std::move(properties), now);
    list_changed_ = true;
    note(true, kBetween, now);
}

void BoardValues::note(bool changed, Duration between, Time now) {
    if (!changed) return;
    ++changes_;
    values_changed_ = true;
    const auto behind = has_contacts_ ? Duration::zero() : kBehind;
    const Time when = published_at_ ? std::max(now + behind, *published_at_ + between) : now;
    if (!due_ || when < *due_) due_ = when;
}

void BoardValues::connected(Time now) {
    list_changed_ = values_changed_ = true;
    due_ = now;
}

void BoardValues::emptied(Time now) {
    if (!again_) again_ = now + kBetweenNumbers;
}

void BoardValues::hurry(Time now) {
    due_ = now;
}

std::optional<Time> BoardValues::next_deadline() const {
    std::optional<Time> first;
    for (const auto& each : {due_, again_, known_.next_deadline()})
        if (each && (!first || *each < *first)) first = each;
    return first;
}

void BoardValues::publish(const std::string& session, Time now, Effects& out) {
    if (again_ && now >= *again_) {
        again_.reset();
        connected(now);
    }
    if (!due_ || now < *due_) return;
    due_.reset();
    if (std::exchange(list_changed_, false)) {
        const property::PropertyList list{{board_.name, session, ++seq_}, known_.properties()};
        out.publish.push_back(
            {member::retained(board_.topics.properties(board_.name), property::to_text(list)),
             mqtt::Priority::kAnnouncement});
    }
    if (!std::exchange(values_changed_, false)) return;
    auto document = property::values_of(known_, now);
    document.head = {board_.name, session, ++seq_};
    document.restarts = restarts_;
    document.clock = age_.clock(now);
    out.publish.push_back({member::retained(board_.topics.values(board_.name), property::to_text(document)),
                           mqtt::Priority::kAnnouncement});
    published_at_ = now;
}

bool BoardValues::may_answer(std::string_view demander, Time now) {
    if (quotas_.size() >= kMaxQuotas && !quotas_.contains(demander))
        std::erase_if(quotas_,
                      [now](const auto& each) { return now - each.second.second > std::chrono::seconds(1); });
    if (quotas_.size() >= kMaxQuotas && !quotas_.contains(demander)) return false;
    auto& quota = quotas_.emplace(std::string(demander), Quota{now, 0}).first->second;
    if (now - quota.second >= std::chrono::seconds(1)) quota = {now, 0};
    return ++quota.answers <= kMaxAnswers;
}

void BoardValues::answer(std::string_view demander, const bus::Demand& demand, const std::string& session,
                         Time now, Effects& out) {
    const auto user = demander.substr(0, demander.find('/'));
    const auto below = board_.topics.root() + "/reply/" + std::string(user) + "/" + board_.name + "/";
    if (!demand.reply_to.starts_with(below) || !may_answer(demander, now)) return;
    const auto asked = [&](const std::string& service) {
        return std::any_of(demand.asked.begin(), demand.asked.end(),
                           [&](const auto& each) { return bus::matches_pattern(each, service); }) ||
               std::any_of(demand.services.begin(), demand.services.end(),
                           [&](const auto& each) { return bus::matches_pattern(each.first, service); });
    };
    auto document = property::values_of(known_, now, asked);
    document.head = {board_.name, session, seq_};
    document.restarts = restarts_;
    document.clock = age_.clock(now);
    if (asked(std::string(kIo))) document.pins = known_.pins(kIo);
    if (demand.list)
        for (const auto& each : known_.properties())
            if (asked(each.service)) document.properties.push_back(each);
    const auto reply = bus::Reply::ok("memory", property::to_text(document));
    bus::ReplyTo to;
    to.topic = demand.reply_to;
    to.id = demand.id;
    if (auto message = bus::reply_message(to, reply))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
}

}  // namespace asip::agent
