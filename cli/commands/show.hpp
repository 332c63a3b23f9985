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

/// `asipctl show`: everything known of a board, or of one service of it.
int run_show(const ShowOptions& options, Environment& environment);

/// The properties whose values are known, as its agent says.
using KnownProperties = std::vector<std::pair<property::Property, nlohmann::json>>;

/// The parts of it, as text. Pure.
std::string board_text(const KnownBoard& board, const model::ModelSet& models, std::size_t width, bool colour,
                       const KnownProperties& known = {});
std::string pins_text(const model::Description& description, std::size_t width, bool colour);
/// One object a pin: board, pin, and mode, owner, can (a list of digital, analog, pwm), channel and label
/// where known.
std::vector<nlohmann::json> pin_records(const model::Description& description);
/// `label`: its friendly name; empty: none.
std::string service_text(const std::string& board, const model::ServiceInfo& service,
                         const std::string& label, const model::ServiceModel* model, std::size_t width,
                         bool colour, const KnownProperties& known = {});

/// The events and commands of a model, as tables.
std::string model_text(const model::ServiceModel& model, std::size_t width, bool colour);

/// A field or argument in words: `angle 0..180 degrees`.
std::string field_text(const model::Field& field);

}  // namespace asip::cli
