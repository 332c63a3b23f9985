// SPDX-License-Identifier: Apache-2.0
#include "agent/describe/label_book.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "agent/command/command_note.hpp"
#include "asip/bus/request/agent_requests.hpp"
#include "asip/model/description.hpp"
#include "asip/model/json.hpp"
#include "asip/text/nearest.hpp"
#include "asip/text/printable.hpp"

namespace asip::agent {

using program::log::Level;

namespace {

template <class Fixed, class Changes>
auto first_fixed(const Fixed& fixed, const Changes& changes) {
    auto it = changes.begin();
    while (it != changes.end() && !fixed.contains(it->first))
        ++it;
    return it;
}

std::string fixed_fault(const std::string& what) {
    return what + " is set in the configuration of the board's agent (--label): change it there";
}

}  // namespace

void LabelBook::load(Expected<model::Labels> kept) {
    fault_ = kept ? std::string() : text::printable(kept.error(), model::kMaxFaultBytes / 4 - 1);
    kept_ = kept ? std::move(*kept) : model::Labels();
    join();
}

void LabelBook::join() {
    current_ = fixed_;
    current_.meanings = kept_.meanings;
    current_.modes = kept_.modes;
    // Descriptions have bounds: labels of the configuration come first.
    for (const auto& label : kept_.labels)
        if (current_.labels.size() < model::kMaxLabels) current_.labels.insert(label);
    const auto names = [this] { return current_.services.size() + current_.pins.size(); };
    for (const auto& service : kept_.services)
        if (names() < model::kMaxFriendlyNames) current_.services.insert(service);
    for (const auto& pin : kept_.pins)
        if (names() < model::kMaxFriendlyNames) current_.pins.insert(pin);
}

std::string LabelBook::why_not(const model::LabelChange& change) const {
    if (const auto it = first_fixed(fixed_.labels, change.labels); it != change.labels.end())
        return fixed_fault("the label " + it->first);
    if (const auto it = first_fixed(fixed_.services, change.services); it != change.services.end())
        return fixed_fault("the name of " + it->first);
    if (const auto it = first_fixed(fixed_.pins, change.pins); it != change.pins.end())
        return fixed_fault("the name of pin " + std::to_string(it->first));
    std::vector<std::string> services;
    for (const auto& entry : board_.services.entries())
        services.push_back(entry.name);
    for (const auto& [name, value] : change.services)
        if (value && !services.empty() && std::find(services.begin(), services.end(), name) == services.end())
            return "the board has no service " + name + text::did_you_mean(name, services);
    const auto pins = board_.session.identity().pin_capabilities.size();
    for (const auto& [pin, value] : change.pins)
        if (value && pins != 0 && static_cast<std::size_t>(pin) >= pins)
            return "the board has pins 0 to " + std::to_string(pins - 1);
    return {};
}

void LabelBook::request(const LabelRequest& wanted, Time now, Effects& out) {
    Request request{wanted.shown(), wanted.change.value_or(model::LabelChange()), wanted.reply()};
    auto why = wanted.change ? why_not(*wanted.change) : wanted.change.error();
    if (!why.empty())
        return answer(request, bus::Reply::refused(std::string(bus::kRefusedInvalid), std::move(why)), now,
                      out);
    if (waiting_.size() >= kMaxWaiting)
        return answer(request,
                      bus::Reply::refused(std::string(bus::kRefusedQueueFull),
                                          "the agent is still writing what was asked for before"),
                      now, out);
    waiting_.push_back(std::move(request));
    if (!begun_) begin_next(now, out);
}

void LabelBook::begin_next(Time now, Effects& out) {
    while (!waiting_.empty()) {
        const auto& change = waiting_.front().change;
        auto next = model::changed(kept_, change);
        // With those of the configuration they must still fit.
        if (next)
            if (const auto all = model::changed(current_, change); !all) next = fail(all.error());
        if (!next) {
            finish(bus::Reply::refused(std::string(bus::kRefusedInvalid), next.error()), now, out);
        } else if (*next == kept_ && !fault_.empty() && !change.empty()) {
            finish(bus::Reply::refused(std::string(bus::kRefusedNotKept), fault_), now, out);
        } else if (*next == kept_) {
            finish(bus::Reply::ok(std::string(bus::kProofKept), answer_json()), now, out);
        } else {
            begun_ = *next;
            for_request_ = true;
            write_modes_at_.reset();
            out.keep_labels = LabelsToKeep{std::move(*next), !fault_.empty()};
            return;
        }
    }
}

void LabelBook::note_modes(const std::vector<std::pair<int, int>>& modes, Time now) {
    auto next = kept_.modes;
    for (const auto& [pin, mode] : modes)
        if (mode == 0)
            next.erase(pin);
        else
            next[pin] = mode;
    if (next == kept_.modes) return;
    kept_.modes = std::move(next);
    if (!write_modes_at_) write_modes_at_ = now + kBetweenWrites;
    join();
}

// What could not be read is not written over for a mode.
void LabelBook::tick(Time now, Effects& out) {
    if (begun_ || !write_modes_at_ || now < *write_modes_at_) return;
    write_modes_at_.reset();
    if (!fault_.empty()) return;
    begun_ = kept_;
    for_request_ = false;
    out.keep_labels = LabelsToKeep{kept_, false};
}

void LabelBook::kept(const Expected<std::filesystem::path>& result, Time now, Effects& out) {
    if (!begun_) return;
    auto written = *std::exchange(begun_, std::nullopt);
    if (!for_request_) {
        if (!result) out.log(Level::kDebug, "modes of pins could not be kept", {{"why", result.error()}});
        return begin_next(now, out);
    }
    written.modes = kept_.modes;  // some may have been set meanwhile
    if (result) {
        kept_ = std::move(written);
        fault_.clear();
        join();
        if (!result->empty())
            out.log(Level::kWarning, "labels that cannot be read were put aside",
                    {{"file", result->string()}});
        finish(bus::Reply::ok(std::string(bus::kProofKept), answer_json(*result)), now, out);
    } else {
        out.log(Level::kError, "labels could not be kept", {{"why", result.error()}});
        finish(bus::Reply::refused(std::string(bus::kRefusedNotKept), result.error()), now, out);
    }
    begin_next(now, out);
}

void LabelBook::finish(bus::Reply reply, Time now, Effects& out) {
    answer(waiting_.front(), std::move(reply), now, out);
    waiting_.pop_front();
}

void LabelBook::answer(const Request& request, bus::Reply reply, Time now, Effects& out) {
    if (!reply.succeeded() && !request.reply.wanted() && refusals_.take(now))
        out.log(Level::kWarning, "labels refused", {{"why", reply.error}, {"by", request.reply.by}});
    if (auto message = bus::reply_message(request.reply, reply))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
    if (!request.change.empty())
        note_command(board_, {"command", {}, request.text, request.reply.by, reply}, out);
}

std::string LabelBook::answer_json(const std::filesystem::path& set_aside) const {
    auto object = nlohmann::json::object();
    model::put_labels(object, current_);
    if (!fault_.empty()) object["labels_fault"] = fault_;
    if (!set_aside.empty()) object["set_aside"] = set_aside.string();
    return model::dump_json(object);
}

}  // namespace asip::agent
