// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

using ModelPtr = std::shared_ptr<const ServiceModel>;

/// The service models that a program knows, one for each name. Copies are cheap, as models are shared and
/// never change. Safe to read in several threads, to change in one.
class ModelSet {
  public:
    /// The models of services/, built into the program. Made at the first call, which throws std::logic_error
    /// if one of them is wrong (the tests make sure that none is).
    static const ModelSet& standard();

    /// Those, and the ones in `folder` where it is not empty. Fails as load_directory().
    static Expected<ModelSet> standard_and(const std::string& folder);

    ModelSet() = default;

    /// Adds every *.json of the folder except schema.json; a model replaces the one of its name. Fails, and
    /// then adds none, with "FILE: /place: reason" when the folder or a file cannot be read, or a file is
    /// larger than 64 KiB or not a valid model.
    Expected<void> load_directory(const std::string& path);
    /// Replaces the model of the same name.
    void add(ServiceModel model);

    /// The model of a service of a board. `friendly_name` is what the board answered to `#,N`, empty if
    /// nothing: then the letter decides, and of two models with one letter the first in the order of their
    /// names. Null when no model fits.
    ModelPtr match(char letter, std::string_view friendly_name) const;
    /// The model of that name; null when unknown.
    ModelPtr find(std::string_view name) const;
    /// The model for a reference such as "distance@1"; null when there is none of this name and version.
    ModelPtr find_ref(std::string_view ref) const;
    /// Whether exactly this model is built into every program, so that a description need only refer to it.
    static bool is_standard(const ServiceModel& model);

    /// In the order of their names.
    const std::vector<ModelPtr>& all() const { return models_; }
    std::vector<std::string> names() const;

  private:
    std::vector<ModelPtr> models_;
};

/// The model in a file. Fails with "FILE: /place: reason" when it cannot be read, is larger than 64 KiB or is
/// no valid model.
Expected<ServiceModel> load_service_model(const std::string& path);

/// The units of the model that a description refers to ("distance@1"; where this version is unknown, of
/// another one); empty: no such model, or it has none.
std::vector<std::string> units_of(const ModelSet& models, std::string_view reference);

}  // namespace asip::model
