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

/// One open stream, of whatever form: Server-Sent Events, a WebSocket, or a wait for a value.
class OpenStream {
  public:
    OpenStream(Principal principal, std::string client)
        : principal_(std::move(principal)), client_(std::move(client)) {}
    virtual ~OpenStream() = default;
    /// Called ten times a second.
    virtual void tick(const Instant& now) = 0;
    /// Its right to read is gone: it ends soon, but not within this call.
    virtual void revoke() = 0;

    /// By whose rights it was opened, and to whom it is counted.
    const Principal& principal() const { return principal_; }
    const std::string& client() const { return client_; }

  private:
    Principal principal_;
    std::string client_;
};

/// All open streams: time for them, how many a client may have, and their end when the right to them ends.
/// Streams add and remove themselves; they must not outlive it.
class Streams {
  public:
    explicit Streams(std::size_t per_client) : per_client_(per_client) {}

    /// Whether a client may open one more. To be asked before one is made: add() takes each.
    bool has_room(const std::string& client) const;
    void add(OpenStream& stream);
    void remove(OpenStream& stream);
    /// Call ten times a second: gives the streams their time, and twice a second revokes those whose right is
    /// gone.
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

/// A feed as Server-Sent Events, with a comment every 15 s, by which both sides learn that the other one is
/// there. It ends when its right is gone, or with an event `fault` when its feed has one.
class SseSource : public http::Source, public OpenStream {
  public:
    static constexpr Duration kComment = std::chrono::seconds(15);

    /// `part`: what the stream takes of its client's budget, beside what its feed takes.
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
