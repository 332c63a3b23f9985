// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>

#include "gateway/api/call.hpp"
#include "gateway/mirror/property_feed.hpp"
#include "gateway/stream/feed.hpp"

namespace asip::gateway::api {

inline constexpr double kMaxHz = 1000;  ///< of values of a service

/// Answers with a stream of Server-Sent Events, or with 429 where its client has too much.
void start_sse(const Call& call, std::unique_ptr<Feed> feed);
/// For a feed of the properties of a board, or of those of one service, as this client sees them.
PropertyFeed::Options feed_options(const Call& call, const std::string& board, const std::string& service,
                                   double max_hz);
/// Behind what a client resumes a stream. Fails with a sentence.
Expected<std::optional<Place>> resume_place(const Call& call);

}  // namespace asip::gateway::api
