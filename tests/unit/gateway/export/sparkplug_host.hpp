// SPDX-License-Identifier: Apache-2.0
// A host of Sparkplug B that believes nothing: it follows what is published and notes each fault of it.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "export_world.hpp"
#include "gateway/export/sparkplug_node.hpp"

namespace asip::gateway::exports {

class SparkplugHost {
  public:
    struct Device {
        std::map<std::string, sparkplug::Metric> metrics;  // by name, without properties
        std::string bytes;                                 // of what it said last
    };

    /// What was published since the last call.
    void follow(const ExportWorld& world) {
        for (; read_ < world.sent.size(); ++read_)
            heard(world.sent[read_]);
    }

    std::vector<std::string> faults;
    std::map<std::string, Device> devices;  // that are alive
    std::map<std::string, int> births, deaths, data;
    bool node_alive = false;
    std::vector<unsigned> bd_seqs;  // of births of the node
    std::size_t messages = 0;       // with a number

    const sparkplug::Metric* metric(const std::string& board, const std::string& name) const {
        const auto device = devices.find(board);
        if (device == devices.end()) return nullptr;
        const auto found = device->second.metrics.find(name);
        return found == device->second.metrics.end() ? nullptr : &found->second;
    }
    sparkplug::Value value(const std::string& board, const std::string& name) const {
        const auto* found = metric(board, name);
        return found == nullptr ? sparkplug::Value(std::string("no such metric")) : found->value;
    }

  private:
    void heard(const ExportWorld::Sent& sent) {
        std::vector<std::string> levels(1);
        for (const char c : sent.topic)
            if (c == '/')
                levels.emplace_back();
            else
                levels.back() += c;
        if (levels[0] != "spBv1.0" || levels.size() < 4 || levels[2] == "NCMD" || levels[2] == "DCMD") return;
        const auto payload = sparkplug::read(sent.payload);
        if (!payload) return fault(sent, "cannot be read: " + payload.error());
        if (!payload->timestamp) fault(sent, "no time");
        if (levels[2] == "NDEATH") return node_death(sent, *payload);
        number(sent, *payload, levels[2]);
        const auto board = levels.size() > 4 ? levels[4] : std::string();
        if (levels[2] == "NBIRTH") return node_birth(sent, *payload);
        if (!node_alive) return fault(sent, "before the birth of the node");
        if (levels[2] == "DBIRTH") {
            ++births[board];
            devices[board] = {};
            for (const auto& each : payload->metrics) {
                if (each.name.empty() || !each.alias || !each.timestamp)
                    fault(sent, "metric without name, alias or time");
                if (!aliases_.insert(each.alias.value_or(0)).second)
                    fault(sent, "an alias that was used before");
                devices[board].metrics[each.name] = each;
            }
            devices[board].bytes = sent.payload;
        } else if (levels[2] == "DDATA") {
            ++data[board];
            if (!devices.contains(board)) return fault(sent, "data of a device that is not born");
            for (const auto& each : payload->metrics)
                take(sent, devices[board], each);
            devices[board].bytes = sent.payload;
        } else if (levels[2] == "DDEATH") {
            ++deaths[board];
            if (devices.erase(board) == 0) fault(sent, "death of a device that is not born");
        } else {
            fault(sent, "unknown");
        }
    }
    void take(const ExportWorld::Sent& sent, Device& device, const sparkplug::Metric& metric) {
        if (!metric.name.empty()) fault(sent, "a name where an alias is known");
        if (!metric.timestamp) fault(sent, "no time of a metric");
        for (auto& [name, known] : device.metrics) {
            if (known.alias != metric.alias) continue;
            if (known.type != metric.type) fault(sent, name + " has another type");
            known.value = metric.value;
            return;
        }
        fault(sent, "an alias that is not known");
    }
    void number(const ExportWorld::Sent& sent, const sparkplug::Payload& payload, const std::string& kind) {
        ++messages;
        const unsigned expected = kind == "NBIRTH" ? 0 : (seq_ + 1) % 256;
        if (payload.seq != expected) fault(sent, "seq is not " + std::to_string(expected));
        seq_ = static_cast<unsigned>(payload.seq.value_or(0));
    }
    static std::optional<unsigned> bd_seq_of(const sparkplug::Payload& payload) {
        for (const auto& each : payload.metrics)
            if (each.name == "bdSeq")
                if (const auto* number = std::get_if<std::int64_t>(&each.value))
                    return static_cast<unsigned>(*number);
        return std::nullopt;
    }
    void node_birth(const ExportWorld::Sent& sent, const sparkplug::Payload& payload) {
        const auto number = bd_seq_of(payload);
        if (!number) return fault(sent, "no bdSeq");
        bd_seqs.push_back(*number);
        node_alive = true;
        devices.clear();
        aliases_.clear();
    }
    void node_death(const ExportWorld::Sent& sent, const sparkplug::Payload& payload) {
        if (payload.seq) fault(sent, "a death has no seq");
        if (bd_seqs.empty() || bd_seq_of(payload) != bd_seqs.back()) return;
        node_alive = false;
        devices.clear();
    }
    void fault(const ExportWorld::Sent& sent, const std::string& what) {
        faults.push_back(sent.topic + ": " + what);
    }

    std::size_t read_ = 0;
    unsigned seq_ = 0;
    std::set<std::uint64_t> aliases_;  // since the birth of the node
};

}  // namespace asip::gateway::exports
