// SPDX-License-Identifier: Apache-2.0
#include "bench/load/questions.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace asip::load {
namespace {

constexpr std::size_t kMaxCursor = 256;  // what a registry takes

// Among 20 questions, in the order of the kinds.
constexpr std::array<std::size_t, kQuestionKinds> kShares{14, 2, 2, 1, 1};
constexpr std::size_t kAllShares = 20;
// Has no factor in common with them: each kind is spread over the 20.
constexpr std::size_t kStride = 7;

QuestionKind kind_of(std::size_t number) {
    std::size_t place = number * kStride % kAllShares;
    std::size_t kind = 0;
    for (; place >= kShares[kind]; ++kind)
        place -= kShares[kind];
    return static_cast<QuestionKind>(kind);
}

/// Boards that differ from this one in the last two digits: at most 100.
std::string like(std::string name) {
    name.replace(name.size() - 2, 2, "??");
    return name;
}

}  // namespace

std::string_view name_of(QuestionKind kind) {
    static constexpr std::array<std::string_view, kQuestionKinds> kNames{"board", "description", "services",
                                                                         "list", "pattern"};
    return kNames[static_cast<std::size_t>(kind)];
}

Question Questions::make(std::size_t board, std::string name) {
    const std::size_t number = number_++;
    const auto kind = kind_of(number);
    if (auto place = std::exchange(places_[static_cast<std::size_t>(kind)], std::nullopt))
        return {kind, std::move(place->query), std::move(place->registry)};
    Question question{.kind = kind, .query = {}, .registry = {}};
    auto& query = question.query;
    query.limit = kPage;
    switch (kind) {
        case QuestionKind::kBoard:
        case QuestionKind::kDescription:
            query.board = std::move(name);
            query.full = kind == QuestionKind::kDescription;
            question.board = board;
            break;
        case QuestionKind::kServices:
            query.find = bus::Find::kServices;
            query.kind = {models_[board % models_.size()]};
            query.state = {"online"};
            break;
        case QuestionKind::kList:
            query.state = {"online"};
            query.brief = true;
            break;
        case QuestionKind::kPattern:
            query.board = like(std::move(name));
            query.brief = true;
            break;
    }
    return question;
}

void Questions::answered(const Question& question, const bus::Answer& answer) {
    if (question.board || answer.cursor.empty() || answer.cursor.size() > kMaxCursor) return;
    auto query = question.query;
    query.cursor = answer.cursor;
    places_[static_cast<std::size_t>(question.kind)] = Place{std::move(query), answer.registry};
}

bool holds(const bus::Answer& answer, std::string_view board) {
    return std::any_of(answer.boards.begin(), answer.boards.end(),
                       [&](const bus::BoardItem& item) { return item.board == board; });
}

std::uint64_t QueryTally::answered() const {
    return std::accumulate(kinds.begin(), kinds.end(), std::uint64_t{0},
                           [](auto sum, const auto& kind) { return sum + kind.answered; });
}

std::uint64_t QueryTally::wrong() const {
    return std::accumulate(kinds.begin(), kinds.end(), std::uint64_t{0},
                           [](auto sum, const auto& kind) { return sum + kind.wrong; });
}

}  // namespace asip::load
