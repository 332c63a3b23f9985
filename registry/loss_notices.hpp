// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <unordered_set>

#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// Messages for a person about boards that are lost and back: one for all that happen together, or while none
/// can be delivered. A board that comes back before the message is sent is left out. Pure.
class LossNotices {
  public:
    static constexpr Duration kGather = std::chrono::milliseconds(500);  ///< from the first change
    static constexpr Duration kApart = std::chrono::seconds(10);         ///< from message to message
    static constexpr Duration kFirstRetry = std::chrono::seconds(1), kMaxRetry = std::chrono::seconds(60);
    static constexpr std::size_t kMaxNamed = 20;      ///< boards and machines that a message names
    static constexpr std::size_t kMaxKept = 100'000;  ///< boards; more are counted only

    explicit LossNotices(std::string registry) : registry_(std::move(registry)) {}

    /// `host`: the machine of its agent; may be empty.
    void lost(const std::string& board, std::string host, model::StateReason reason, Instant now);
    void back(const std::string& board, Instant now);
    void forgotten(const std::string& board);

    /// The JSON to send now; then none until delivered() or failed().
    std::optional<std::string> next(Instant now);
    void delivered(Time now);
    /// Sent again later, with what happened meanwhile, not before `wait` is over.
    void failed(Time now, Duration wait = {});
    /// No receiver takes it: it is dropped.
    void refused(Time now) { delivered(now); }

  private:
    struct Change {
        bool lost = true;
        std::string host{};
        model::StateReason reason = model::StateReason::kNone;
        text::WallTime at{};
    };
    using Changes = std::map<std::string, Change>;

    void note(const std::string& board, Change change, Instant now);
    std::string message(Instant now) const;
    std::string text() const;

    std::string registry_;
    Changes waiting_, sent_;
    std::size_t more_lost_ = 0, more_lost_sent_ = 0;  // beyond kMaxKept
    std::unordered_set<std::string> told_;            // of which the last that was sent is that they are lost
    bool under_way_ = false;
    std::optional<Time> since_;  // the first of waiting_
    Time not_before_{};
    Duration retry_ = kFirstRetry;
};

}  // namespace asip::registry
