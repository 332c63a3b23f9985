// SPDX-License-Identifier: Apache-2.0
#include "asip/bus/request/demand.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "asip/bus/request/line_service.hpp"
#include "asip/model/json.hpp"
#include "asip/model/names.hpp"
#include "asip/text/json_reader.hpp"

namespace asip::bus {
namespace {

constexpr int kMaxDepth = 4;
constexpr std::size_t kMaxReplyTopicBytes = 512;
constexpr std::size_t kMaxIdBytes = 128;
constexpr std::uint64_t kLongestLease = static_cast<std::uint64_t>(kMaxDemandLease.count());

void read_services(text::JsonReader& reader, Demand& demand) {
    auto services = reader.object("services");
    if (!services) return;
    if (services->value().size() > kMaxDemandedServices)
        return services->fault({}, "has more than " + std::to_string(kMaxDemandedServices) + " members");
    for (const auto& [name, value] : services->value().items()) {
        if (!can_be_demanded(name)) return services->fault({}, "a name that no service can have");
        const double hz = value.is_number() ? value.get<double>() : -1;
        if (!(hz >= 0)) return services->fault(name, "must be a number of values a second, 0 or above");
        if (hz > 0)
            demand.services.emplace(name, hz);
        else
            demand.asked.push_back(name);
    }
}

}  // namespace

bool can_be_demanded(std::string service) {
    if (service == kLineService) return true;
    std::replace_if(service.begin(), service.end(), [](char c) { return c == '*' || c == '?'; }, 'x');
    return model::valid_name(service);
}

std::string to_text(const Demand& demand) {
    nlohmann::json services = nlohmann::json::object();
    for (const auto& [name, hz] : demand.services)
        services[name] = hz;
    for (const auto& name : demand.asked)
        if (!services.contains(name)) services[name] = 0;
    nlohmann::json object{{"services", std::move(services)}, {"lease", demand.lease.count()}};
    if (!demand.reply_to.empty()) object["reply_to"] = demand.reply_to;
    if (!demand.id.empty()) object["id"] = demand.id;
    if (demand.list) object["list"] = true;
    return model::dump_json(object);
}

Expected<Demand> parse_demand(std::string_view text) {
    const auto document = model::parse_json(text, {kMaxDemandBytes, kMaxDepth});
    if (!document) return fail(document.error());
    std::string fault;
    text::JsonReader reader(*document, "", fault);
    Demand demand;
    reader.required("services");
    if (reader.ok()) read_services(reader, demand);
    const auto lease = reader.integer("lease", 1, kLongestLease);
    if (lease) demand.lease = std::chrono::seconds(*lease);
    demand.reply_to = reader.text("reply_to", {}, kMaxReplyTopicBytes);
    demand.id = reader.text("id", {}, kMaxIdBytes);
    demand.list = reader.flag("list");
    if (!reader.ok()) return fail(fault);
    return demand;
}

}  // namespace asip::bus
