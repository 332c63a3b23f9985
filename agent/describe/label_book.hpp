// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <filesystem>
#include <optional>
#include <string>

#include "agent/bridge/board.hpp"
#include "agent/bridge/effects.hpp"
#include "agent/counts/allowance.hpp"
#include "agent/inbound/inbound.hpp"
#include "asip/expected.hpp"
#include "asip/model/labels.hpp"

namespace asip::agent {

/// Labels and friendly names of the board: those of the configuration, which are fixed, and those that were
/// set over the bus, which are kept on the disk. Requests are answered one after the other, each once it is
/// on the disk; from then on it counts. Pure.
class LabelBook {
  public:
    static constexpr std::size_t kMaxWaiting = 64;
    /// A disk is not written for each mode that a program sets.
    static constexpr Duration kBetweenWrites = std::chrono::seconds(10);

    /// `fixed`: the labels of the configuration.
    LabelBook(const Board& board, model::Labels fixed) : board_(board), fixed_(std::move(fixed)) {}

    /// The description and each answer tell a fault until labels are set anew.
    void load(Expected<model::Labels> kept);

    /// Names are checked against the board's services and pins, where those are known.
    void request(const LabelRequest& request, Time now, Effects& out);
    /// What became of Effects::keep_labels: where an unreadable file was put; empty: there was none.
    void kept(const Expected<std::filesystem::path>& result, Time now, Effects& out);

    /// Modes that commands set hold at once, and are on the disk within kBetweenWrites.
    void note_modes(const std::vector<std::pair<int, int>>& modes, Time now);
    void hurry(Time now) {
        if (write_modes_at_) write_modes_at_ = now;
    }
    void tick(Time now, Effects& out);
    std::optional<Time> next_deadline() const { return begun_ ? std::nullopt : write_modes_at_; }

    const model::Labels& current() const { return current_; }
    /// Why labels that were kept do not count; empty: all do.
    const std::string& fault() const { return fault_; }

  private:
    struct Request {
        std::string text;
        model::LabelChange change;
        bus::ReplyTo reply;
    };
    std::string why_not(const model::LabelChange& change) const;
    void begin_next(Time now, Effects& out);
    void finish(bus::Reply reply, Time now, Effects& out);
    void answer(const Request& request, bus::Reply reply, Time now, Effects& out);
    std::string answer_json(const std::filesystem::path& set_aside = {}) const;
    void join();

    const Board& board_;
    model::Labels fixed_;
    model::Labels kept_;
    model::Labels current_;
    std::string fault_;
    std::optional<model::Labels> begun_;  // being written
    bool for_request_ = false;            // for the first of waiting_; else for the modes alone
    std::optional<Time> write_modes_at_;  // modes were set since the last writing
    std::deque<Request> waiting_;
    Allowance refusals_{20, 1};  // that are logged
};

}  // namespace asip::agent
