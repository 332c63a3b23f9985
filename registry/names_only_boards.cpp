// SPDX-License-Identifier: Apache-2.0
#include "registry/names_only_boards.hpp"

#include <utility>

namespace asip::registry {

NamesOnlyBoards::NamesOnlyBoards(const bus::Topics& topics, Port port)
    : topics_(topics), port_(std::move(port)) {}

void NamesOnlyBoards::add(const std::string& board, Time now) {
    questions_.emplace(board, Question{now + kDelay});
}

void NamesOnlyBoards::remove(const std::string& board) {
    const auto question = questions_.find(board);
    if (question != questions_.end()) {
        if (question->second.open) close(board, question->second);
        questions_.erase(question);
    }
    if (listened_.erase(board) == 0) return;
    if (!to_all_) {
        port_.unsubscribe(topics_.board_out(board));
        port_.unsubscribe(topics_.service_out(board, "+"));
    } else if (listened_.size() <= kMaxListened / 2) {
        listen_to_each();
    }
}

void NamesOnlyBoards::listen_to_each() {
    to_all_ = false;
    for (const std::string& board : listened_) {
        port_.subscribe(topics_.board_out(board), false);
        port_.subscribe(topics_.service_out(board, "+"), false);
    }
    port_.unsubscribe(topics_.board_out("+"));
    port_.unsubscribe(topics_.service_out("+", "+"));
}

void NamesOnlyBoards::listen(const std::string& board) {
    if (!listened_.insert(board).second || to_all_) return;
    to_all_ = listened_.size() > kMaxListened;
    const std::string which = to_all_ ? "+" : board;
    port_.subscribe(topics_.board_out(which), false);
    port_.subscribe(topics_.service_out(which, "+"), false);
    if (!to_all_) return;
    for (const std::string& each : listened_) {
        if (each == board) continue;
        port_.unsubscribe(topics_.board_out(each));
        port_.unsubscribe(topics_.service_out(each, "+"));
    }
}

bool NamesOnlyBoards::must_wait(const Question& question) const {
    return open_ >= kMaxOpen || (question.probes() && probing_ >= kMaxProbes);
}

void NamesOnlyBoards::ask(const std::string& board, Question& question, Time now) {
    listen(board);
    port_.subscribe(topics_.description(board), true);
    ++open_;
    if (question.probes()) {
        ++probing_;
        mqtt::Message probe;
        probe.topic = topics_.probe();
        probe.payload = board;
        port_.publish(std::move(probe));
    }
    question.open = true;
    question.at = now + kQuestionTime;
    ++question.asked;
}

void NamesOnlyBoards::close(const std::string& board, Question& question) {
    port_.unsubscribe(topics_.description(board));
    question.open = false;
    --open_;
    if (question.asked > 1) --probing_;
}

void NamesOnlyBoards::step(const std::string& board, Question& question, Time now) {
    if (question.open) {
        close(board, question);
        question.at = now + kQuestionTime * (1 << question.asked);
    } else if (!must_wait(question)) {
        ask(board, question, now);
    } else {
        listen(board);
    }
}

void NamesOnlyBoards::tick(Time now) {
    for (auto each = questions_.begin(); each != questions_.end();) {
        auto& [board, question] = *each;
        if (now >= question.at) step(board, question, now);
        each = question.asked == kQuestions && !question.open ? questions_.erase(each) : std::next(each);
    }
}

}  // namespace asip::registry
