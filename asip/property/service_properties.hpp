// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "asip/model/description.hpp"
#include "asip/model/hints.hpp"
#include "asip/model/service_model.hpp"
#include "asip/property/property.hpp"

namespace asip::property {

/// Those of one service that has a model; without the I/O service's pins.
std::vector<Property> service_properties(const model::Description& description,
                                         const model::ServiceInfo& service, const model::ServiceModel& model);
/// By the pins' meanings and the modes that commands set.
std::vector<Property> pin_properties(const model::Description& description, const model::ServiceInfo& io);

bool is_number(const model::Field& field);
/// The different numbers of a field's names, each with its first word.
std::vector<std::pair<std::string, double>> named_numbers(const model::Field& field);
/// {"off", N}, {"on", M} of a field with two values; empty: it has others.
std::vector<std::pair<std::string, double>> two_values(const model::Field& field,
                                                       const model::FieldHints& hints);
/// A field can be nothing else.
bool names_say_all(const model::Field& field);

/// The command that brings a whole service to its safe state: "T,P,0,0".
std::optional<Call> stop_call(const std::string& service, const model::ServiceModel& model);

/// "stop-all" -> "stop all"
std::string words_of(std::string_view name);
std::string capital(std::string text);

void describe_number(Property& property, const model::Field& field, const model::FieldHints& hints);
/// A switch, a choice, or a number.
void make_settable(Property& property, const model::Field& argument, const model::FieldHints& hints);

}  // namespace asip::property
