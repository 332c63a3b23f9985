// SPDX-License-Identifier: Apache-2.0
#include "agent/reports/report_periods.hpp"

#include <algorithm>
#include <cmath>

#include "asip/model/service_model.hpp"
#include "asip/protocol/body.hpp"
#include "asip/protocol/request.hpp"

namespace asip::agent {

using program::log::Level;

namespace {

constexpr unsigned kSlowest = 65535;
constexpr Duration kFirstPatience = std::chrono::seconds(1);
constexpr Duration kMaxPatience = std::chrono::seconds(60);

/// The argument of a model's `report`, where that is the request that the protocol has for it.
const model::Field* period_argument(const model::ServiceModel* model) {
    const auto* report = model == nullptr ? nullptr : model->command("report");
    if (report == nullptr || report->tag != 'A' || report->args.size() != 1) return nullptr;
    const auto& period = report->args.front();
    return period.type == model::ValueType::kInteger && period.unit == "ms" ? &period : nullptr;
}

unsigned within_bounds(std::chrono::milliseconds period) {
    return static_cast<unsigned>(std::clamp<std::int64_t>(period.count(), 0, kSlowest));
}

}  // namespace

unsigned period_for(double hz, unsigned fastest, unsigned slowest) {
    if (!(hz > 0)) return 0;
    const double period = std::ceil(1000 / hz);
    if (!(period < slowest)) return slowest;
    return std::clamp(static_cast<unsigned>(period), std::min(fastest, slowest), slowest);
}

void ReportPeriods::look_again(Time when) {
    if (!look_at_ || when < *look_at_) look_at_ = when;
}

void ReportPeriods::demand(std::string_view demander, const Expected<bus::Demand>& wanted, Time now) {
    if (!options_.on_demand) return;
    if (!wanted || !demands_.take(demander, *wanted, now)) {
        ++rejected_;
        return;
    }
    look_again(looked_at_ ? std::max(now, *looked_at_ + kBetweenLooks) : now);
}

void ReportPeriods::queued(session::RequestId id, const protocol::Request& request) {
    if (!options_.on_demand) return;
    if (request.service == '#' && request.tag == 'R') foreign_.emplace(id, Foreign{'#', 0});
    if (request.tag != 'A' || !services_.contains(request.service)) return;
    const auto period = protocol::parse_integer(request.parameters);
    if (period && *period >= 0 && *period <= kSlowest)
        foreign_.emplace(id, Foreign{request.service, static_cast<unsigned>(*period)});
}

ReportPeriods::Service* ReportPeriods::find(char letter) {
    const auto known = services_.find(letter);
    return known == services_.end() ? nullptr : &known->second;
}

void ReportPeriods::on_finished(const session::Finished& end, Time now, Effects& out) {
    if (!options_.on_demand) return;
    if (const auto foreign = foreign_.find(end.id); foreign != foreign_.end()) {
        foreign_ended(foreign->second, end);
        foreign_.erase(foreign);
        look_again(now);
        return;
    }
    for (auto& [letter, service] : services_)
        if (service.request == end.id) return own_ended(service, end, now, out);
}

void ReportPeriods::foreign_ended(const Foreign& request, const session::Finished& end) {
    using session::Ending;
    if (end.ending == Ending::kNotSent || end.ending == Ending::kBoardError) return;
    const bool executed = end.ending == Ending::kExecuted || end.ending == Ending::kUnproven;
    if (request.letter == '#') {
        commanded_.clear();
        for (auto& [letter, service] : services_)
            service.set.reset();
        return;
    }
    if (executed) commanded_[request.letter] = request.period;
    if (auto* service = find(request.letter))
        service->set = executed ? std::optional(request.period) : std::nullopt;
}

void ReportPeriods::own_ended(Service& service, const session::Finished& end, Time now, Effects& out) {
    using session::Ending;
    const unsigned asked = service.asked;
    service.request = 0;
    if (end.ending == Ending::kExecuted || end.ending == Ending::kUnproven) {
        service.set = asked;
        service.failed.reset();
        service.patience = {};
        ++changes_;
        out.log(Level::kDebug, "reports on demand",
                {{"service", service.name}, {"period", std::to_string(asked)}});
    } else {
        service.set.reset();
        if (end.ending == Ending::kBoardError && service.failed != asked)
            out.log(Level::kWarning, "the board refuses a period for reports",
                    {{"service", service.name}, {"period", std::to_string(asked)}, {"why", end.text}});
        service.failed = asked;
        service.patience = std::clamp(service.patience * 2, kFirstPatience, kMaxPatience);
        service.again = now + service.patience;
    }
    service.not_before = now + kBetweenChanges;
    look_again(service.not_before);
}

void ReportPeriods::board_found(const session::ServiceTable& services, Time now) {
    if (!options_.on_demand) return;
    auto before = std::exchange(services_, {});
    for (const auto& entry : services.entries()) {
        const auto* period = period_argument(entry.model.get());
        if (period == nullptr) continue;
        auto& service = services_[entry.letter];
        if (const auto known = before.find(entry.letter);
            known != before.end() && known->second.name == entry.name)
            service = std::move(known->second);
        service.letter = entry.letter;
        service.name = entry.name;
        service.fastest = static_cast<unsigned>(std::clamp(period->min.value_or(0), 1.0, 65535.0));
        service.slowest =
            static_cast<unsigned>(std::clamp(period->max.value_or(kSlowest), 1.0, double{kSlowest}));
        service.set.reset();
    }
    std::erase_if(commanded_, [this](const auto& one) { return !services_.contains(one.first); });
    look_again(now);
}

bool ReportPeriods::controls(char letter) const {
    const auto known = services_.find(letter);
    return known != services_.end() && (!options_.shared || known->second.touched);
}

std::optional<unsigned> ReportPeriods::own_period(char letter) const {
    const auto known = services_.find(letter);
    if (!options_.shared || known == services_.end()) return std::nullopt;
    const auto commanded = commanded_.find(letter);
    return commanded != commanded_.end() ? commanded->second : known->second.before;
}

unsigned ReportPeriods::demanded(const Service& service) const {
    return period_for(demands_.hz(service.name, service.letter),
                      std::max(service.fastest, within_bounds(options_.fastest)), service.slowest);
}

unsigned ReportPeriods::wanted(const Service& service) const {
    const auto commanded = commanded_.find(service.letter);
    const unsigned resting = options_.shared ? service.before.value_or(0)
                                             : std::min(within_bounds(options_.resting), service.slowest);
    const unsigned base = commanded != commanded_.end() ? commanded->second : resting;
    const unsigned most = demanded(service);
    return base == 0 || most == 0 ? std::max(base, most) : std::min(base, most);
}

bool ReportPeriods::left_alone(const Service& service) const {
    return options_.shared && !service.touched && demanded(service) == 0;
}

void ReportPeriods::tick(session::BoardSession& session, Time now, session::Actions& actions) {
    if (demands_.expire(now)) look_again(now);
    if (!look_at_ || now < *look_at_) return;
    look_at_.reset();
    if (!session.accepts_requests()) return;  // until the board is found
    looked_at_ = now;
    for (auto& [letter, service] : services_) {
        if (service.request != 0 || left_alone(service)) continue;
        if (!service.touched) service.before = session.period(letter);
        const unsigned period = wanted(service);
        if (service.set == period) continue;
        const Time when = service.failed == period ? service.again : service.not_before;
        if (now < when) {
            look_again(when);
            continue;
        }
        service.asked = period;
        const auto id = session.submit(std::string{letter, ','} + "A," + std::to_string(period),
                                       {.client = kClient}, now, actions);
        if (id) {
            service.request = *id;
            service.touched = true;
        } else
            look_again(service.not_before = now + kBetweenChanges);
    }
}

std::map<std::string, unsigned> ReportPeriods::periods() const {
    std::map<std::string, unsigned> result;
    for (const auto& [letter, service] : services_)
        if (service.set) result[service.name] = *service.set;
    return result;
}

std::optional<Time> ReportPeriods::next_deadline() const {
    auto first = demands_.next_deadline();
    if (look_at_ && (!first || *look_at_ < *first)) first = look_at_;
    return first;
}

}  // namespace asip::agent
