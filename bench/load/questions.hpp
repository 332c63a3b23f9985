// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "asip/bus/registry/answer.hpp"
#include "asip/bus/registry/query.hpp"
#include "bench/load/times.hpp"

namespace asip::load {

/// What registries are asked, as people's programs ask.
enum class QuestionKind : std::uint8_t {
    kBoard,        ///< one board by its name
    kDescription,  ///< the same with its whole description
    kServices,     ///< a page of services by kind and state
    kList,         ///< a page of short rows of boards by state
    kPattern,      ///< a page of short rows of boards whose names are like a pattern
};
constexpr std::size_t kQuestionKinds = 5;
/// "board", "description", "services", "list", "pattern"
std::string_view name_of(QuestionKind kind);

/// One question, and what its answer is judged by.
struct Question {
    QuestionKind kind = QuestionKind::kBoard;
    bus::Query query;
    std::string registry;                ///< that is asked; empty: whichever answers
    std::optional<std::size_t> board{};  ///< the one that is asked for
};

/// Decides which question is next: 14 of 20 are for one board, 2 for a description, 2 for services, 1 for a
/// list and 1 for a pattern; boards are drawn at random. Pure. Each run draws the same boards.
class Questions {
  public:
    /// Boards or services of one page, as asipctl asks.
    static constexpr std::size_t kPage = 100;

    /// `models`: services that the boards have; not empty. `boards`: how many there are.
    Questions(std::vector<std::string> models, std::size_t boards)
        : models_(std::move(models)), boards_(boards) {}

    /// `name_of_board` gives the name of a board by its number.
    template <class Names>
    Question next(Names&& name_of_board) {
        const std::size_t board = random_() % boards_;
        return make(board, name_of_board(board));
    }
    /// The answer to a page: the next question of its kind goes on behind it.
    void answered(const Question& question, const bus::Answer& answer);

  private:
    /// Where the pages of one kind go on, and at which registry: cursors are of one registry.
    struct Place {
        bus::Query query;
        std::string registry;
    };
    Question make(std::size_t board, std::string name);

    std::vector<std::string> models_;
    std::size_t boards_;
    std::minstd_rand random_;
    std::size_t number_ = 0;
    std::array<std::optional<Place>, kQuestionKinds> places_{};
};

/// Whether an answer holds the board.
bool holds(const bus::Answer& answer, std::string_view board);

/// What became of the questions of one kind.
struct QuestionTally {
    std::uint64_t asked = 0, answered = 0, unanswered = 0;
    std::uint64_t refused = 0;  ///< of those that were answered
    std::uint64_t wrong = 0;    ///< likewise: without a board that is there, or not to be read
    Times took;                 ///< from the question to its answer
};
/// The same of all kinds.
struct QueryTally {
    std::array<QuestionTally, kQuestionKinds> kinds;
    std::uint64_t left_out = 0;  ///< too many waited for their answers

    QuestionTally& operator[](QuestionKind kind) { return kinds[static_cast<std::size_t>(kind)]; }
    std::uint64_t answered() const;
    std::uint64_t wrong() const;
};

}  // namespace asip::load
