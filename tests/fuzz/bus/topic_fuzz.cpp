// SPDX-License-Identifier: Apache-2.0
// Any topic either is none of ours, or is rebuilt from its parts byte by byte.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "asip/bus/topics.hpp"

namespace {

std::string rebuilt(const asip::bus::Topics& topics, const asip::bus::TopicRef& ref) {
    using enum asip::bus::TopicKind;
    switch (ref.kind) {
        case kBoardNames:
            return topics.board_names();
        case kServiceNames:
            return topics.service_names(ref.board);
        case kState:
            return topics.state(ref.board);
        case kDescription:
            return topics.description(ref.board);
        case kStats:
            return topics.stats(ref.board);
        case kLog:
            return topics.log(ref.board);
        case kCommands:
            return topics.commands(ref.board);
        case kProperties:
            return topics.properties(ref.board);
        case kValues:
            return topics.values(ref.board);
        case kLinks:
            return topics.links(ref.board);
        case kLink:
            return topics.link(ref.board, ref.demander);
        case kDemand:
            return topics.demand(ref.board, ref.demander);
        case kProbe:
            return topics.probe();
        case kBoardOut:
            return topics.board_out(ref.board);
        case kBoardIn:
            return topics.board_in(ref.board);
        case kStop:
            return topics.stop(ref.board);
        case kServiceOut:
            return topics.service_out(ref.board, ref.service);
        case kServiceIn:
            return topics.service_in(ref.board, ref.service);
        case kServiceError:
            return topics.service_error(ref.board, ref.service);
        case kServiceSet:
            return topics.service_set(ref.board, ref.service);
        case kRegistryState:
            return topics.registry_state(ref.board);
        case kRegistryStats:
            return topics.registry_stats(ref.board);
        case kRegistryEvents:
            return topics.registry_events(ref.board);
        case kRegistryQuery:
            return topics.registry_query(ref.board);
        case kAnyRegistryQuery:
            return topics.any_registry_query();
    }
    std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const asip::bus::Topics topics("asip");
    const std::string topic(reinterpret_cast<const char*>(data), size);
    if (const auto ref = topics.parse(topic); ref && rebuilt(topics, *ref) != topic) std::abort();
    if (asip::bus::Topics::valid_root(topic)) {
        const asip::bus::Topics other(topic);
        if (!other.parse(other.state("uno1"))) std::abort();
    }
    return 0;
}
