// SPDX-License-Identifier: Apache-2.0
#include "registry/queries.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace asip::registry {
namespace {

constexpr std::size_t kMaxForgottenAtOnce = 1000;
constexpr std::size_t kEnvelopeBytes = 1024;  // of an answer beside its items, and more than enough

/// How many items a page may have that fits, judged by this one, which had up to `limit`; nothing: it does.
std::optional<std::size_t> limit_that_fits(const bus::Answer& page, std::size_t limit,
                                           std::size_t max_bytes) {
    const auto bytes = max_bytes == 0 ? 0 : bus::encode(page).size() + kEnvelopeBytes;
    if (bytes <= max_bytes || limit == 1) return std::nullopt;
    limit = std::min(limit, bus::Query::kMaxPage);
    return std::max<std::size_t>(1, std::min(limit - 1, limit * max_bytes / bytes * 9 / 10));
}

bus::Answer refusal(std::string reason, std::string error) {
    bus::Answer answer;
    answer.refused = std::move(reason);
    answer.error = std::move(error);
    return answer;
}

}  // namespace

Queries::Queries(std::string registry, Dependencies dependencies)
    : registry_(std::move(registry)), dependencies_(std::move(dependencies)) {}

bus::Answer Queries::complete(bus::Answer answer) const {
    answer.registry = registry_;
    answer.epoch = epoch_;
    if (answer.refused.empty()) answer.seq = dependencies_.seq();
    answer.settling = settling_;
    return answer;
}

bus::Answer Queries::refuse(std::string reason, std::string error) const {
    return complete(refusal(std::move(reason), std::move(error)));
}

void Queries::answer(const Request& request, std::size_t max_bytes, const Done& done) {
    if (const auto* forgetting = std::get_if<bus::Forget>(&request))
        return done(complete(forget(*forgetting)));
    const auto& query = std::get<bus::Query>(request);
    if (query.find != bus::Find::kHistory && query.find != bus::Find::kValues)
        return done(complete(find(query, max_bytes)));
    if (!keeps(query.find)) return done(refuse_kept(query.find));
    kept(query, max_bytes, done);
}

void Queries::kept(bus::Query query, std::size_t max_bytes, const Done& done) {
    const auto& ask = query.find == bus::Find::kValues ? dependencies_.values : dependencies_.history;
    ask(query, [this, query, max_bytes, done](bus::Answer page) mutable {
        const auto smaller = limit_that_fits(page, query.limit, max_bytes);
        if (!smaller) return done(complete(std::move(page)));
        query.limit = *smaller;
        kept(std::move(query), max_bytes, done);
    });
}

bus::Answer Queries::refuse_kept(bus::Find find) const {
    const std::string what = find == bus::Find::kValues ? "values" : "history";
    return refuse("no-history", "this registry keeps no " + what + "; start it with --history FILE");
}

bus::Answer Queries::find(bus::Query query, std::size_t max_bytes) {
    if (query.full) query.limit = std::min(query.limit, bus::Query::kMaxFullPage);
    for (;;) {
        Expected<bus::Answer> answer = query.find == bus::Find::kModels
                                           ? models(query)
                                           : dependencies_.catalogue.find(query, dependencies_.now());
        if (!answer) return refusal("invalid", answer.error());
        const auto smaller = limit_that_fits(*answer, query.limit, max_bytes);
        if (!smaller) return std::move(*answer);
        query.limit = *smaller;
    }
}

bus::Answer Queries::models(const bus::Query& query) const {
    bus::Answer answer;
    answer.find = bus::Find::kModels;
    std::string last;
    for (const auto& model : dependencies_.models.all()) {
        const bool wanted = query.kind.empty() ||
                            std::find(query.kind.begin(), query.kind.end(), model->name) != query.kind.end();
        if (!wanted || model->name <= query.cursor) continue;
        if (answer.models.size() == query.limit) {
            answer.cursor = last;
            break;
        }
        answer.models.push_back(model->source);
        last = model->name;
    }
    return answer;
}

bus::Answer Queries::forget(const bus::Forget& forget) {
    Catalogue& catalogue = dependencies_.catalogue;
    const Instant now = dependencies_.now();
    const bool pattern = forget.board.find_first_of("*?") != std::string::npos;
    bus::Answer answer;
    if (!pattern) {
        const auto known = catalogue.board(forget.board, now);
        if (!known) return refusal("unknown-board", "no board \"" + forget.board + "\" is known");
        if (known->state != "lost" && known->state != "offline") {
            return refusal("alive",
                           "board \"" + forget.board + "\" is " + known->state +
                               " and would be back with its next announcement; stop its agent first");
        }
        answer.forgotten = {forget.board};
    } else {
        answer.forgotten = catalogue.forgettable(forget.board);
        if (answer.forgotten.size() > kMaxForgottenAtOnce) answer.forgotten.resize(kMaxForgottenAtOnce);
    }
    if (!forget.dry_run) {
        for (const std::string& board : answer.forgotten)
            if (auto events = catalogue.forget(board, now.time)) dependencies_.forgotten(*events);
    }
    return answer;
}

}  // namespace asip::registry
