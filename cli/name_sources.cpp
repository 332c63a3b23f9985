// SPDX-License-Identifier: Apache-2.0
#include "cli/name_sources.hpp"

#include "asip/bus/registry/board_match.hpp"
#include "cli/find/target.hpp"

namespace asip::cli {
namespace {

using Words = std::vector<std::string>;

Words units_of(const model::ModelSet& models) {
    Words result;
    const auto add = [&result](const std::vector<model::Field>& fields) {
        for (const auto& field : fields)
            if (!field.unit.empty()) result.push_back(field.unit);
    };
    for (const auto& name : models.names()) {
        const auto model = models.find(name);
        for (const auto& event : model->events)
            add(event.fields);
        for (const auto& command : model->commands)
            add(command.args);
    }
    return result;
}

}  // namespace

NameSources bus_names(const Environment& environment, BoardSource& source, std::function<bool()> connected) {
    const auto board = [&source, connected](const std::string& name) {
        return connected() ? source.retained_board(name) : std::nullopt;
    };
    const auto model = [&environment, board](const std::string& name, const std::string& service) {
        const auto found = board(name);
        const auto info = found ? find_service(*found, service) : failure(program::kExitFailure, {});
        return info ? bus::model_of(*info, environment.models()) : nullptr;
    };
    NameSources names;
    names.boards = [&source, connected] { return connected() ? source.names() : Words(); };
    names.services = [board](const std::string& name) {
        const auto found = board(name);
        return found ? found->service_names() : Words();
    };
    names.commands = [model](const std::string& name, const std::string& service) {
        Words result;
        if (const auto found = model(name, service))
            for (const auto& command : found->commands)
                result.push_back(command.name);
        return result;
    };
    names.fields = [model](const std::string& name, const std::string& service) {
        Words result;
        if (const auto found = model(name, service))
            for (const auto& event : found->events)
                result.push_back(event.name);
        return result;
    };
    names.kinds = [&environment] { return environment.models().names(); };
    names.units = [&environment] { return units_of(environment.models()); };
    names.labels = [&source, connected] {
        Words result;
        if (!connected()) return result;
        const auto boards = source.boards({});
        if (!boards) return result;
        for (const auto& each : *boards)
            for (const auto& [key, value] : each.labels.labels)
                result.push_back(key + "=" + value);
        return result;
    };
    return names;
}

}  // namespace asip::cli
