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

/// Service models, one for each name. Copies are cheap: models are shared and never change. Safe to read in
/// several threads.
class ModelSet {
  public:
    /// The models of services/, built in. Made at the first call, which throws std::logic_error on a wrong
    /// one.
    static const ModelSet& standard();

    /// Those, and the ones in `folder`, if any. Fails as load_directory().
    static Expected<ModelSet> standard_and(const std::string& folder);

    ModelSet() = default;

    /// Adds every *.json of the folder except schema.json, replacing models of the same names. Fails, adding
    /// none, with "FILE: /place: reason" on a file that is unreadable, above 64 KiB or not valid.
    Expected<void> load_directory(const std::string& path);
    /// Replaces the model of the same name.
    void add(ServiceModel model);

    /// By `friendly_name`, what the board answered to `#,N`; where that is empty, by the letter, the first in
    /// the order of names. Null: none fits.
    ModelPtr match(char letter, std::string_view friendly_name) const;
    /// Null: unknown.
    ModelPtr find(std::string_view name) const;
    /// For a reference such as "distance@1"; null: unknown name or version.
    ModelPtr find_ref(std::string_view ref) const;
    /// Every program has exactly this model, so that a description need only refer to it.
    static bool is_standard(const ServiceModel& model);

    /// In the order of their names.
    const std::vector<ModelPtr>& all() const { return models_; }
    std::vector<std::string> names() const;

  private:
    std::vector<ModelPtr> models_;
};

/// Fails with "FILE: /place: reason" on a file that is unreadable, above 64 KiB or not valid.
Expected<ServiceModel> load_service_model(const std::string& path);

/// Those of "distance@1", or of another version where this one is unknown; may be empty.
std::vector<std::string> units_of(const ModelSet& models, std::string_view reference);

}  // namespace asip::model
