// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "registry/catalogue_types.hpp"

namespace asip::registry {

/// What a registry counts, and the document that it publishes of that and its catalogue.
class Statistics {
  public:
    struct Counts {
        std::uint64_t connections = 0;
        std::uint64_t messages = 0;         ///< received
        std::uint64_t queries = 0;          ///< answered
        std::uint64_t events = 0;           ///< published
        std::uint64_t denied = 0;           ///< published and denied by the broker's access rules
        std::uint64_t history_dropped = 0;  ///< changes that the history file was too slow for
        std::string history_fault;          ///< why the history file cannot be used now
        std::uint64_t values_kept = 0;      ///< properties
        std::uint64_t values_lost = 0;      ///< changes that had no room
        std::string values_fault;           ///< why the file of values cannot be used now
    };

    Statistics(Duration interval, Time now) : interval_(interval), started_(now), last_(now) {}

    Counts counts;

    bool due(Time now) const { return now - last_ >= interval_; }
    /// Not due before an interval is over.
    void postpone(Time now) { last_ = now; }
    Duration age(Time now) const { return now - started_; }
    /// The payload of `$stats`, documented in docs/asip-registry.md. The next is due an interval later.
    std::string document(const Catalogue& catalogue, const std::string& epoch, std::uint64_t seq,
                         Instant now);

  private:
    Duration interval_;
    Time started_;
    Time last_;                        // of the last document
    std::uint64_t messages_then_ = 0;  // counts.messages at that time
};

}  // namespace asip::registry
