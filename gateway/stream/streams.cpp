// SPDX-License-Identifier: Apache-2.0
#include "gateway/stream/streams.hpp"

#include <vector>

namespace asip::gateway {
namespace {

constexpr Duration kCheck = std::chrono::milliseconds(500);  // an ended right ends its streams within a
                                                             // second

}  // namespace

bool Streams::has_room(const std::string& client) const {
    const auto found = clients_.find(client);
    return found == clients_.end() || found->second < per_client_;
}

void Streams::add(OpenStream& stream) {
    streams_.insert(&stream);
    ++clients_[stream.client()];
}

void Streams::remove(OpenStream& stream) {
    if (streams_.erase(&stream) == 0) return;
    const auto found = clients_.find(stream.client());
    if (found != clients_.end() && --found->second == 0) clients_.erase(found);
}

void Streams::tick(const Instant& now, const Gate& gate) {
    for (auto* stream : streams_)
        stream->tick(now);
    if (now.time - checked_ >= kCheck) end_those_without_right(now, gate);
}

void Streams::end_those_without_right(const Instant& now, const Gate& gate) {
    checked_ = now.time;
    std::vector<OpenStream*> revoked;
    for (auto* stream : streams_)
        if (!gate.still_admitted(stream->principal(), now)) revoked.push_back(stream);
    for (auto* stream : revoked)
        if (streams_.count(stream) > 0) stream->revoke();
}

SseSource::SseSource(Streams& streams, std::unique_ptr<Feed> feed, std::function<Instant()> now,
                     Principal principal, std::string client, Budget::Part part)
    : OpenStream(std::move(principal), std::move(client)),
      streams_(streams),
      feed_(std::move(feed)),
      now_(std::move(now)),
      part_(std::move(part)) {
    last_ = now_().time;
    feed_->wake = [this] { wake(); };
    streams_.add(*this);
}

SseSource::~SseSource() {
    streams_.remove(*this);
}

void SseSource::take(std::string& out, std::size_t max) {
    if (revoked_) return;
    const auto now = now_();
    if (!begun_) {
        begun_ = true;
        out += "retry: 1000\n\n";
    }
    StreamEvent event;
    while (out.size() < max && feed_->next(event, now))
        append_sse(out, event);
    if (const auto fault = feed_->fault(); !fault.empty()) {
        append_sse(out, {"fault", {}, R"({"error":")" + std::string(fault) + "\"}"});
        revoked_ = true;
    }
    if (out.empty() && now.time - last_ >= kComment) out += ":\n\n";
    if (!out.empty()) last_ = now.time;
}

void SseSource::tick(const Instant& now) {
    feed_->tick(now);
    if (now.time - last_ >= kComment) wake();
}

void SseSource::revoke() {
    revoked_ = true;
    wake();
}

}  // namespace asip::gateway
