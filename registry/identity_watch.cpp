// SPDX-License-Identifier: Apache-2.0
#include "registry/identity_watch.hpp"

#include <nlohmann/json.hpp>

#include "asip/bus/registry/query.hpp"
#include "asip/model/json.hpp"

namespace asip::registry {

IdentityWatch::IdentityWatch(const bus::Topics& topics, std::string id, std::string run,
                             std::string reply_topic, const std::string& question)
    : topics_(topics), id_(std::move(id)), run_(std::move(run)), reply_topic_(std::move(reply_topic)) {
    bus::Query query;
    query.limit = 1;
    query.brief = true;
    probe_ = bus::encode(bus::RegistryRequest{query, question, reply_topic_});
}

mqtt::Message IdentityWatch::probe() const {
    return mqtt::Message{.topic = topics_.registry_query(id_), .payload = probe_};
}

std::optional<std::string> IdentityWatch::other(const mqtt::Message& message) const {
    const auto document = model::parse_json(message.payload, {.max_bytes = 1u << 20, .max_depth = 16});
    if (!document || !document->is_object() || message.retain) return std::nullopt;
    if (message.topic == reply_topic_ && document->value("registry", "") != id_) return std::nullopt;
    const auto epoch = document->find("epoch");
    if (epoch == document->end() || !epoch->is_string()) return std::nullopt;
    const auto& text = epoch->get_ref<const std::string&>();
    if (text.empty() || text.compare(0, run_.size(), run_) == 0) return std::nullopt;
    return text.substr(0, 64);
}

}  // namespace asip::registry
