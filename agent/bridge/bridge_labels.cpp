// SPDX-License-Identifier: Apache-2.0
// Labels and friendly names of the board, which its agent keeps.
#include "agent/bridge/bridge.hpp"
#include "asip/bus/label_request.hpp"
#include "asip/bus/request_envelope.hpp"

namespace asip::agent {

using program::log::Level;

void Bridge::load_labels(Effects& out) {
    auto kept = options_.load_labels ? options_.load_labels(name_) : Expected<model::Labels>();
    if (!kept) out.log(Level::kError, "labels cannot be read", {{"why", kept.error()}});
    labels_.load(std::move(kept));
    facts_.labels = labels_.current();
    facts_.labels_fault = labels_.fault();
}

bool Bridge::take_label_request(const mqtt::Message& message, Effects& out) {
    const auto& text = message.payload;
    if (message.retain ||
        (text.find("\"labels\"") == std::string::npos && text.find("\"names\"") == std::string::npos))
        return false;
    const auto envelope = bus::open_envelope(message);
    if (!envelope || envelope->form != bus::RequestEnvelope::Form::kJson ||
        !bus::is_label_request(envelope->object))
        return false;
    labels_.request(name_, *envelope, {services_, session_.identity().pin_capabilities.size()}, out);
    show_labels();
    return true;
}

void Bridge::labels_kept(const Expected<std::filesystem::path>& result, Effects& out) {
    labels_.kept(result, out);
    show_labels();
}

void Bridge::show_labels() {
    if (facts_.labels == labels_.current() && facts_.labels_fault == labels_.fault()) return;
    facts_.labels = labels_.current();
    facts_.labels_fault = labels_.fault();
    describe_again();
}

}  // namespace asip::agent
