// SPDX-License-Identifier: Apache-2.0
#include "agent/safety/stop_latch.hpp"

#include <utility>

#include "asip/session/request.hpp"
#include "asip/text/printable.hpp"

namespace asip::agent {

namespace {

/// As a description may hold it.
std::string shown(const std::string& text) {
    if (text.size() <= model::kMaxStopBytes && text::is_showable(text)) return text;
    return text::printable(text, model::kMaxStopBytes / 4);
}

}  // namespace

void StopLatch::load(Expected<std::optional<model::StopInfo>> kept) {
    if (kept)
        stopped_ = std::move(*kept);
    else
        stopped_ = model::StopInfo{{}, shown(kept.error()), {}};
}

bool StopLatch::stop(std::string by, std::string why, std::string since) {
    if (stopped_) return false;
    stopped_ = {shown(by), shown(why), std::move(since)};
    return true;
}

bool StopLatch::resume() {
    return std::exchange(stopped_, std::nullopt).has_value();
}

bool StopLatch::holds(const session::ServiceTable& services, const protocol::Request& request) const {
    if (!stopped_ || session::is_question(request.service, request.tag)) return false;
    const auto* service = services.find(request.service);
    const auto* command =
        service != nullptr && service->model ? service->model->command_with_tag(request.tag) : nullptr;
    return command == nullptr || (command->answer == 0 && command->name != "report");
}

std::string StopLatch::why_refused(const std::string& board) const {
    if (!stopped_) return {};
    std::string text = "the board is stopped";
    if (!stopped_->by.empty()) text += " by " + stopped_->by;
    if (!stopped_->since.empty()) text += " since " + stopped_->since;
    if (!stopped_->why.empty()) text += " (" + stopped_->why + ")";
    return text + "; it takes commands again after: asipctl resume " + board;
}

}  // namespace asip::agent
