// SPDX-License-Identifier: Apache-2.0
#include "registry/values/value_keeper.hpp"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <optional>
#include <utility>

#include "registry/history/store.hpp"

namespace asip::registry {

/// What the other thread does, and what came of it.
struct ValueKeeper::Work {
    std::function<void(ValueFile& file, Work& work)> use;
    std::function<void(const Work& work)> then;
    std::string fault{}, aside{}, damage{};
    std::optional<Tick> last{};
    bool all_written = true;
    bus::Answer answer{};
};

namespace {

constexpr const char* kSlow = "the disk takes long to write; ask again in some seconds";

bus::Answer refused(const std::string& why) {
    bus::Answer answer;
    answer.refused = "history-fault";
    answer.error = "values cannot be read now, and it is tried again: " + why;
    return answer;
}

}  // namespace

ValueKeeper::ValueKeeper(boost::asio::io_context& io, ValueFile::Options options, Handlers handlers,
                         Instant now)
    : io_(io),
      options_(std::move(options)),
      handlers_(std::move(handlers)),
      now_(now),
      thread_(options_.own_thread) {
    write(now);
}

ValueKeeper::~ValueKeeper() {
    thread_.join();
    if (!recorder_.running()) return;
    Work work{.use = {}, .then = {}};
    for (auto rows : {rows_, std::make_shared<ValueRows>(recorder_.take(now_))}) {
        if (!rows) continue;
        work.use = [&rows](ValueFile& file, Work&) { file.write(*rows); };
        perform(work);
    }
}

/// A second time only where the first has found damage.
void ValueKeeper::perform(Work& work) {
    for (int attempt = 0; attempt < 2; ++attempt) {
        try {
            work.fault.clear();
            if (!file_) file_ = std::make_unique<ValueFile>(options_);
            return work.use(*file_, work);
        } catch (const std::exception& error) {
            file_.reset();
            work.fault = error.what();
            const auto* fault = dynamic_cast<const HistoryFault*>(&error);
            if (fault == nullptr || !fault->damaged) return;
            work.damage = work.fault;
            work.aside = put_aside(options_.path);
            if (work.aside.empty()) {
                work.fault += ", and it cannot be put aside: move it";
                return;
            }
        }
    }
}

void ValueKeeper::run(std::shared_ptr<Work> work) {
    thread_.post([this, work = std::move(work)] {
        perform(*work);
        boost::asio::post(io_, [this, work] {
            if (!work->aside.empty() && handlers_.begun_anew) handlers_.begun_anew(work->aside, work->damage);
            work->then(*work);
        });
    });
}

void ValueKeeper::write(Instant now) {
    busy_ = true;
    began_ = now.time;
    next_write_ = now.time + kWriteInterval;
    next_mark_ = now.time + kMarkInterval;
    if (recorder_.running() && !rows_) rows_ = std::make_shared<ValueRows>(recorder_.take(now));
    auto work = std::make_shared<Work>();
    work->use = [rows = rows_](ValueFile& file, Work& result) {
        if (rows) result.all_written = file.write(*rows);
        result.last = file.last();
    };
    work->then = [this](const Work& result) { done(result); };
    run(std::move(work));
}

void ValueKeeper::failed(const std::string& why) {
    if (fault_.empty()) {
        lost_before_ = lost();
        if (handlers_.failed) handlers_.failed(why);
    }
    fault_ = why;
}

void ValueKeeper::done(const Work& work) {
    busy_ = false;
    if (!work.fault.empty()) {
        failed(work.fault);
        next_write_ = now_.time + retry_;
        retry_ = std::min(2 * retry_, kMaxRetry);
        return;
    }
    if (!work.all_written) ++left_out_;
    rows_.reset();
    retry_ = kWriteInterval;
    if (!std::exchange(fault_, {}).empty() && handlers_.works_again)
        handlers_.works_again(lost() - lost_before_);
    if (!recorder_.running()) recorder_.begin(work.last, now_);
}

void ValueKeeper::set(const PropertyKey& key, double value, Instant now) {
    now_ = now;
    recorder_.set(key, value, now);
}

void ValueKeeper::tick(Instant now) {
    now_ = now;
    recorder_.tick(now);
    if (busy_ && now.time - began_ >= kStalled) failed("the disk has not answered for some seconds");
    if (is_slow(now))
        for (const auto& each : std::exchange(asked_, {}))
            std::exchange(*each, nullptr)(refused(kSlow));
    if (busy_ || now.time < next_write_) return;
    const bool wanted = rows_ || !recorder_.running() || recorder_.waits() || now.time >= next_mark_;
    if (wanted) write(now);
}

void ValueKeeper::find(bus::Query query, Instant now, Found found) {
    if (!fault_.empty()) return found(refused(fault_));
    if (!recorder_.running()) return found(refused("the file is being opened"));
    if (is_slow(now)) return found(refused(kSlow));
    const auto asked = asked_.emplace_back(std::make_shared<Found>(std::move(found)));
    auto work = std::make_shared<Work>();
    work->use = [query = std::move(query), present = recorder_.present(now)](ValueFile& file, Work& result) {
        result.answer = file.find(query, present);
    };
    work->then = [this, asked](const Work& result) {
        std::erase(asked_, asked);
        if (*asked) (*asked)(result.fault.empty() ? result.answer : refused(result.fault));
    };
    run(std::move(work));
}

}  // namespace asip::registry
