// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>

#include "gateway/api/call.hpp"
#include "gateway/stream/feed.hpp"
#include "gateway/stream/place.hpp"

namespace asip::gateway::api {

/// Answers with a stream of Server-Sent Events, or with 429 where its client has too much.
void start_sse(const Call& call, std::unique_ptr<Feed> feed);
/// Behind what a client resumes a stream. Fails with a sentence.
Expected<std::optional<Place>> resume_place(const Call& call);

}  // namespace asip::gateway::api
