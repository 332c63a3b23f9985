// SPDX-License-Identifier: Apache-2.0
#include "asip/catalogue/model_units.hpp"

#include <stdexcept>

#include "asip/model/model_set.hpp"

namespace asip::catalogue {

UnitsOf units_of_models(const std::string& folder) {
    model::ModelSet models = model::ModelSet::standard();
    if (!folder.empty()) {
        if (auto loaded = models.load_directory(folder); !loaded) throw std::runtime_error(loaded.error());
    }
    return [models = std::move(models)](std::string_view reference) {
        return model::units_of(models, reference);
    };
}

}  // namespace asip::catalogue
