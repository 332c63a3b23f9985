// SPDX-License-Identifier: Apache-2.0
#include "asip/model/description.hpp"

#include <algorithm>

namespace asip::model {

bool operator==(const ServiceInfo& a, const ServiceInfo& b) {
    const auto own = [](const ServiceInfo& service) {
        return service.own_model ? std::string_view(service.own_model->source) : std::string_view{};
    };
    return a.name == b.name && a.id == b.id && a.model == b.model && own(a) == own(b) && a.title == b.title &&
           a.count == b.count && a.period == b.period;
}

const ServiceInfo* Description::service(std::string_view name) const {
    const auto found = std::find_if(services.begin(), services.end(),
                                    [&](const ServiceInfo& service) { return service.name == name; });
    return found == services.end() ? nullptr : &*found;
}

}  // namespace asip::model
