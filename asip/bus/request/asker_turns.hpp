// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <deque>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace asip::bus {

/// Questions, or answers, that wait. Askers take turns. Bounded: `max_of_asker` for each, `max` in all; where
/// it is full, an asker with fewer takes the last place of the one with most. Pure.
template <class Question, std::size_t max_of_asker = 32, std::size_t max = 1024>
class AskerTurns {
  public:
    static constexpr std::size_t kMaxOfAsker = max_of_asker;
    static constexpr std::size_t kMax = max;

    /// What has no place: this question, or the one that made room for it.
    std::optional<Question> push(const std::string& asker, Question question) {
        auto own = std::find_if(turns_.begin(), turns_.end(),
                                [&asker](const Turn& turn) { return turn.asker == asker; });
        const auto waiting = own == turns_.end() ? 0 : own->questions.size();
        if (waiting == kMaxOfAsker) return question;
        std::optional<Question> displaced;
        if (size_ == kMax) {
            const auto most = std::max_element(
                turns_.begin(), turns_.end(),
                [](const Turn& a, const Turn& b) { return a.questions.size() < b.questions.size(); });
            if (most->questions.size() <= waiting + 1) return question;
            displaced = std::move(most->questions.back());
            most->questions.pop_back();
            --size_;
        }
        if (own == turns_.end()) own = turns_.insert(turns_.end(), Turn{asker, {}});
        own->questions.push_back(std::move(question));
        ++size_;
        return displaced;
    }
    /// The oldest question of the asker whose turn it is. Not when empty().
    Question pop() {
        auto& turn = turns_.front();
        Question question = std::move(turn.questions.front());
        turn.questions.pop_front();
        --size_;
        if (turn.questions.empty())
            turns_.pop_front();
        else
            turns_.splice(turns_.end(), turns_, turns_.begin());
        return question;
    }
    bool empty() const { return size_ == 0; }
    /// It would have no place for another question of this asker.
    bool full_of(std::string_view asker) const {
        const auto own = std::find_if(turns_.begin(), turns_.end(),
                                      [&asker](const Turn& turn) { return turn.asker == asker; });
        return own != turns_.end() && own->questions.size() == kMaxOfAsker;
    }

  private:
    struct Turn {
        std::string asker;
        std::deque<Question> questions;  // never empty
    };
    std::list<Turn> turns_;  // the first one is next
    std::size_t size_ = 0;
};

}  // namespace asip::bus
