#include "registry/model_units.hpp"

#include <stdexcept>

#include "asip/model/model_set.hpp"

namespace asip::registry {

UnitsOf units_of_models(const std::string& folder) {
    model::ModelSet models = model::ModelSet::standard();
    if (!folder.empty()) {
        if (auto loaded = models.load_directory(folder); !loaded) throw std::runtime_error(loaded.error());
    }
    return [models = std::move(models)](std::string_view reference) {
        std::vector<std::string> units;
        const auto add = [&units](const std::string& unit) {
            if (!unit.empty()) units.push_back(unit);
        };
        const auto model = models.find_ref(reference);
        if (!model) return units;
        for (const auto& event : model->events) {
            for (const auto& field : event.fields)
                add(field.unit);
        }
        for (const auto& command : model->commands) {
            for (const auto& argument : command.args)
                add(argument.unit);
        }
        return units;
    };
}

}  // namespace asip::registry
