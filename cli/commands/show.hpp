// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "asip/model/service_model.hpp"
#include "asip/property/property.hpp"
#include "cli/ask/board_source.hpp"
#include "cli/environment.hpp"
#include "cli/output.hpp"

namespace asip::cli {

struct ShowOptions {
    std::string target;
    OutputOptions output{};
};

int run_show(const ShowOptions& options, Environment& environment);

/// Those with known values.
using KnownProperties = std::vector<std::pair<property::Property, nlohmann::json>>;

/// Pure.
std::string board_text(const KnownBoard& board, const model::ModelSet& models, std::size_t width, bool colour,
                       const KnownProperties& known = {});
std::string pins_text(const model::Description& description, std::size_t width, bool colour);
/// For each pin: board, pin, and mode, owner, can, channel and label where known.
std::vector<nlohmann::json> pin_records(const model::Description& description);
/// `label`: may be empty.
std::string service_text(const std::string& board, const model::ServiceInfo& service,
                         const std::string& label, const model::ServiceModel* model, std::size_t width,
                         bool colour, const KnownProperties& known = {});

/// Events and commands, as tables.
std::string model_text(const model::ServiceModel& model, std::size_t width, bool colour);

/// `angle 0..180 degrees`.
std::string field_text(const model::Field& field);

}  // namespace asip::cli
