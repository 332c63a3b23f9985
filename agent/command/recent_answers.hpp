// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "asip/bus/request/reply.hpp"
#include "asip/time.hpp"

namespace asip::agent {

/// Remembers requests for a minute, so that a repeated one is answered again and not executed again. Keeps at
/// least kGuaranteed of them while their answers are short, and never more than kMaxBytes; beyond, the oldest
/// is forgotten and counted. Keys and payloads are hashes of 64 bits. Pure.
class RecentAnswers {
  public:
    static constexpr std::size_t kGuaranteed = 16'384;
    static constexpr std::size_t kMaxBytes = 2 << 20;
    static constexpr Duration kKept = std::chrono::minutes(1);

    /// From the topic of a request, its sender's reply topic and its id.
    using Key = std::uint64_t;
    static Key key(std::string_view topic, std::string_view reply_topic, std::string_view id);

    enum class Seen {
        kNew,           ///< it is remembered as pending from now on
        kPending,       ///< the same was seen and has not ended
        kAnswered,      ///< the same was seen and has ended: see find()
        kOtherPayload,  ///< another request had this key
    };
    /// `sent`: when the request was sent, where it says so.
    Seen see(Key key, std::string_view payload, Time now, std::optional<Time> sent = {});
    /// A request that was refused may be tried again, and is new then, unless it was sent no later: that is a
    /// copy. Nothing happens where the request was forgotten.
    void answer(Key key, const bus::Reply& reply);
    /// Without its id; none: not answered, or forgotten.
    std::unique_ptr<bus::Reply> find(Key key) const;

    std::size_t size() const { return entries_.size(); }
    /// In memory, with the containers.
    std::size_t bytes() const;
    std::uint64_t dropped() const { return dropped_; }

  private:
    struct Entry {
        std::uint64_t payload = 0;
        std::optional<Time> sent;
        std::uint32_t number = 0;  // distinguishes it from one that had the key before
        bool answered = false;
        // Null: pending, or the most frequent answer, "ok, by a fence".
        std::shared_ptr<const bus::Reply> reply;
        bool refused() const { return reply && reply->status == bus::Reply::Status::kRefused; }
    };
    struct Turn {
        Time seen;
        Key key;
        std::uint32_t number;
    };
    static constexpr std::size_t kEntryBytes = sizeof(Entry) + sizeof(Turn) + sizeof(Key) + 3 * sizeof(void*);

    void forget_old(std::optional<Time> now);
    void erase(Key key);

    std::unordered_map<Key, Entry> entries_;
    std::deque<Turn> turns_;  // in the order seen; entries that were erased may still be in here
    std::map<std::string, std::shared_ptr<const bus::Reply>> refusals_;  // by reason, of which there are few
    std::size_t reply_bytes_ = 0;
    std::uint32_t next_number_ = 0;
    std::uint64_t dropped_ = 0;
};

}  // namespace asip::agent
