#include "sim/part_reader.hpp"

#include <nlohmann/json.hpp>

namespace asip::sim {

int PartReader::pin(const std::string& key) {
    const auto* value = settings_.required(key);
    if (value == nullptr) return 0;
    const auto pin = board_.parse_pin(value->is_string() ? value->get<std::string>() : value->dump());
    if (!pin) settings_.fault(key, pin.error());
    return pin.value_or(0);
}

}  // namespace asip::sim
