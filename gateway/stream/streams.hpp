// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <string>
#include <unordered_set>

#include "gateway/auth/gate.hpp"
#include "gateway/http/server.hpp"
#include "gateway/stream/budget.hpp"
#include "gateway/stream/feed.hpp"

namespace asip::gateway {

/// Server-Sent Events, a WebSocket, or a wait for a value.
class OpenStream {
  public:
    OpenStream(Principal principal, std::string client)
        : principal_(std::move(principal)), client_(std::move(client)) {}
    virtual ~OpenStream() = default;
    /// Ten times a second.
    virtual void tick(const Instant& now) = 0;
    /// Its right is gone: it ends soon, not within this call.
    virtual void revoke() = 0;

    /// By whose rights it was opened.
    const Principal& principal() const { return principal_; }
    const std::string& client() const { return client_; }

  private:
    Principal principal_;
    std::string client_;
};

/// All open streams: their time, their number for each client, and their end with the right to them. Streams
/// add and remove themselves, and must not outlive it.
class Streams {
  public:
    explicit Streams(std::size_t per_client) : per_client_(per_client) {}

    /// Ask before one is made: add() takes each.
    bool has_room(const std::string& client) const;
    void add(OpenStream& stream);
    void remove(OpenStream& stream);
    /// Ten times a second; twice a second it revokes streams whose right is gone.
    void tick(const Instant& now, const Gate& gate);
    /// The same at once: something was just revoked.
    void end_those_without_right(const Instant& now, const Gate& gate);
    std::size_t size() const { return streams_.size(); }

  private:
    std::size_t per_client_;
    std::unordered_set<OpenStream*> streams_;
    std::map<std::string, std::size_t> clients_;
    Time checked_{};
};

/// A feed as Server-Sent Events, with a comment every 15 s. It ends with its right, or with an event `fault`.
class SseSource : public http::Source, public OpenStream {
  public:
    static constexpr Duration kComment = std::chrono::seconds(15);

    /// `part`: for the stream, beside what its feed takes.
    SseSource(Streams& streams, std::unique_ptr<Feed> feed, std::function<Instant()> now, Principal principal,
              std::string client, Budget::Part part = {});
    ~SseSource() override;

    void take(std::string& out, std::size_t max) override;
    bool finished() const override { return revoked_; }
    bool more() const override { return !revoked_ && feed_->more(); }
    void tick(const Instant& now) override;
    void revoke() override;

  private:
    Streams& streams_;
    std::unique_ptr<Feed> feed_;
    std::function<Instant()> now_;
    Budget::Part part_;
    Time last_{};
    bool begun_ = false;
    bool revoked_ = false;
};

}  // namespace asip::gateway
