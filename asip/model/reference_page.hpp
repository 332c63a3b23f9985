#pragma once
#include <string>

#include "asip/model/model_set.hpp"

namespace asip::model {

/// A Markdown page for people: each model with its events, commands, arguments and examples, by name.
std::string reference_page(const ModelSet& models);

}  // namespace asip::model
