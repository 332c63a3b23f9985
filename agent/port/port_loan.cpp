// SPDX-License-Identifier: Apache-2.0
#include "agent/port/port_loan.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "asip/model/json.hpp"

namespace asip::agent {

using program::log::Level;

namespace {

bool agree(const std::string& a, const std::string& b) {
    return a.empty() || b.empty() || a == b;
}

nlohmann::json traits_json(const BoardTraits& traits) {
    nlohmann::json object = nlohmann::json::object();
    if (!traits.chip.empty()) object["chip"] = traits.chip;
    if (!traits.sketch.empty()) object["sketch"] = traits.sketch;
    if (!traits.stored_name.empty()) object["name"] = traits.stored_name;
    if (!traits.version.empty()) object["version"] = traits.version;
    return object;
}

}  // namespace

bool may_be_same_board(const BoardTraits& a, const BoardTraits& b) {
    return agree(a.chip, b.chip) && agree(a.stored_name, b.stored_name);
}

void PortLoan::answer(const bus::ReplyTo& to, bus::Reply reply, Effects& out) const {
    if (auto message = bus::reply_message(to, std::move(reply)))
        out.publish.push_back({std::move(*message), mqtt::Priority::kReply});
}

void PortLoan::request(const PortRequest& request, const Lent& board, Time now, text::WallTime wall,
                       Effects& out) {
    const auto& reply = request.reply();
    const auto& wanted = request.wanted;
    if (!wanted)
        return answer(reply, bus::Reply::refused(std::string(bus::kRefusedInvalid), wanted.error()), out);
    if (wanted->what == bus::PortRequest::What::kRelease) {
        // Its sender does not wait for the port any more, and would not give it back.
        if (now >= request.deadline()) return answer(reply, bus::Reply::timeout(), out);
        return release(*wanted, reply, board, now, wall, out);
    }
    if (wanted->what == bus::PortRequest::What::kLoad) {
        if (now >= request.deadline()) return answer(reply, bus::Reply::timeout(), out);
        return load(*wanted, reply, board, now, out);
    }
    if (load_) return answer(reply, refusal(), out);
    if (phase_ != Phase::kReleased)
        return answer(reply,
                      bus::Reply::refused(std::string(bus::kRefusedNotReleased),
                                          phase_ == Phase::kOurs ? "the port is the agent's already"
                                                                 : "the port is being taken back"),
                      out);
    take_reply_ = reply;
    take_back(now, out);
}

void PortLoan::release(const bus::PortRequest& request, const bus::ReplyTo& reply, const Lent& board,
                       Time now, text::WallTime wall, Effects& out) {
    const bool prolongs = is_away() && !load_ && !reply.by.empty() && reply.by == by_;
    if (phase_ != Phase::kOurs && !prolongs) return answer(reply, refusal(), out);
    until_ = now + request.time;
    until_wall_ = wall + request.time;
    if (prolongs) {
        deadline_ = until_;
        return answer(reply, bus::Reply::ok("released", granted()), out);
    }
    begin(reply, board, now);
}

void PortLoan::begin(const bus::ReplyTo& reply, const Lent& board, Time now) {
    by_ = reply.by;
    before_ = board;
    release_reply_ = reply;
    phase_ = Phase::kMakingSafe;
    deadline_ = now + (board.ready ? kMakeSafe : Duration::zero());
}

bus::Reply PortLoan::refusal() const {
    const auto by = by_.empty() ? "an unnamed user" : by_;
    return bus::Reply::refused(std::string(bus::kRefusedReleased),
                               load_ ? "firmware is being loaded for " + by
                                     : "the port is released to " + by + " until " + until_text());
}

void PortLoan::load(const bus::PortRequest& request, const bus::ReplyTo& reply, const Lent& board, Time now,
                    Effects& out) {
    if (phase_ != Phase::kOurs) return answer(reply, refusal(), out);
    if (board.link.kind != "serial")
        return answer(
            reply,
            bus::Reply::refused(std::string(bus::kRefusedNotLoaded), "the board is not at a serial port"),
            out);
    if (request.update && (!board.ready || board.traits.available.empty())) {
        if (!board.ready)
            return answer(
                reply, bus::Reply::refused(std::string(bus::kRefusedNotLoaded), "the board does not answer"),
                out);
        before_ = board;
        return answer(reply, found(board.traits), out);
    }
    if (board.ready && !request.force && !request.update)
        return answer(
            reply,
            bus::Reply::refused(std::string(bus::kRefusedSpeaksAsip),
                                "the board runs ASIP already (" + board.traits.sketch +
                                    "); to load other firmware all the same: \"force\":true, --force"),
            out);
    load_ = request;
    if (request.update) load_->firmware = board.traits.sketch;
    step_ = "connecting";
    percent_ = 0;
    begin(reply, board, now);
}

void PortLoan::loading(std::string_view step, int percent) {
    step_ = step;
    percent_ = percent;
}

void PortLoan::loaded(const Expected<void>& result, Time now, Effects& out) {
    if (phase_ != Phase::kReleased || !load_) return;
    step_ = "starting";
    take_back(now, out);
    if (result) return;
    phase_ = Phase::kOurs;
    by_.clear();
    load_.reset();
    out.log(Level::kError, "firmware not loaded", {{"why", result.error()}});
    answer(std::exchange(take_reply_, {}),
           bus::Reply::refused(std::string(bus::kRefusedNotLoaded), result.error()), out);
}

std::string PortLoan::granted() const {
    nlohmann::json object = traits_json(before_.traits);
    object["kind"] = before_.link.kind;
    object["path"] = before_.link.path;
    object["host"] = before_.host;
    object["until"] = until_text();
    return model::dump_json(object);
}

void PortLoan::let_go(Time now, Effects& out) {
    if (phase_ != Phase::kMakingSafe) return;
    phase_ = Phase::kReleased;
    deadline_ = until_;
    out.port = Effects::Port::kLetGo;
    if (load_) {
        take_reply_ = std::exchange(release_reply_, {});
        deadline_ = now + kLoadTime;
        out.load = Effects::Load{before_.link.path, load_->firmware, load_->board};
        return out.log(Level::kInfo, "loading firmware", {{"for", by_}, {"firmware", load_->firmware}});
    }
    out.log(Level::kInfo, "port released", {{"to", by_}, {"until", until_text()}});
    answer(release_reply_, bus::Reply::ok("released", granted()), out);
}

void PortLoan::take_back(Time now, Effects& out) {
    phase_ = Phase::kTakingBack;
    deadline_ = now + kAnswerTime;
    out.port = Effects::Port::kTakeBack;
}

void PortLoan::identified(const BoardTraits& traits, Effects& out) {
    if (phase_ != Phase::kTakingBack) return;
    phase_ = Phase::kOurs;
    const bool same = may_be_same_board(before_.traits, traits);
    out.log(same ? Level::kInfo : Level::kWarning,
            same ? "port taken back" : "port taken back; another board answers there",
            {{"sketch", traits.sketch}, {"was", before_.traits.sketch}});
    answer(std::exchange(take_reply_, {}), found(traits), out);
    by_.clear();
    load_.reset();
}

bus::Reply PortLoan::found(const BoardTraits& after) const {
    if (load_ && load_->update && !after.available.empty())
        return bus::Reply::refused(std::string(bus::kRefusedNotLoaded),
                                   "it was loaded, but the board says that it has " + after.sketch + " " +
                                       (after.version.empty() ? "without a version" : after.version) +
                                       ", not " + after.available);
    const nlohmann::json object{{"same", may_be_same_board(before_.traits, after)},
                                {"before", traits_json(before_.traits)},
                                {"after", traits_json(after)}};
    return bus::Reply::ok("answer", model::dump_json(object));
}

bool PortLoan::tick(Time now, Effects& out) {
    if (phase_ == Phase::kOurs || now < deadline_) return false;
    if (phase_ == Phase::kMakingSafe) {
        let_go(now, out);
        return false;
    }
    if (phase_ == Phase::kReleased) {
        out.log(Level::kWarning, "the port was not given back in time; taking it", {{"from", by_}});
        take_back(now, out);
        return false;
    }
    phase_ = Phase::kOurs;
    by_.clear();
    out.log(Level::kError, "port taken back, but no board answers there; was the sketch loaded completely?");
    answer(std::exchange(take_reply_, {}),
           load_ ? bus::Reply::refused(std::string(bus::kRefusedNotLoaded),
                                       "it was loaded, but the board does not answer; press its reset button")
                 : bus::Reply::timeout(),
           out);
    load_.reset();
    return true;
}

std::optional<Time> PortLoan::next_deadline() const {
    return phase_ == Phase::kOurs ? std::nullopt : std::optional(deadline_);
}

std::string PortLoan::updating() const {
    if (load_ && (is_away() || phase_ == Phase::kTakingBack))
        return model::dump_json(
            {{"by", by_}, {"firmware", load_->firmware}, {"step", step_}, {"percent", percent_}});
    if (!is_away()) return {};
    return model::dump_json({{"by", by_}, {"until", until_text()}});
}

}  // namespace asip::agent
