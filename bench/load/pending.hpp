// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <unordered_map>
#include <vector>

#include "asip/caller/caller.hpp"
#include "asip/time.hpp"

namespace asip::load {

/// Requests whose answers are awaited: kMax at a time, each for kPatience. Dropping a request gives it up at
/// the requester, too. Time is passed in.
class Pending {
  public:
    static constexpr std::size_t kMax = 2000;
    static constexpr std::chrono::milliseconds kPatience{10'000};

    bool full() const { return waiting_.size() >= kMax; }
    bool empty() const { return waiting_.empty(); }
    /// `kind`: whatever the caller tells them apart by.
    void add(caller::Caller::Question request, Time sent, std::size_t kind = 0);
    /// It has its answer. False: it was not awaited any more.
    bool end(const std::string& id) { return waiting_.erase(id) > 0; }
    /// Forgets those that were sent too long ago, and gives the kind of each.
    std::vector<std::size_t> forget_overdue(Time now);
    /// The kind of each that is awaited.
    std::vector<std::size_t> kinds() const;

  private:
    struct Waiting {
        caller::Caller::Question request;
        Time sent;
        std::size_t kind;
    };
    std::unordered_map<std::string, Waiting> waiting_;
};

}  // namespace asip::load
