#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asip/expected.hpp"
#include "asip/model/service_model.hpp"

namespace asip::model {

using ModelPtr = std::shared_ptr<const ServiceModel>;

/// The service models a program knows. Copies are cheap (models are shared).
class ModelSet {
  public:
    /// The models of services/, built into the program.
    static const ModelSet& standard();

    ModelSet() = default;

    /// Adds every *.json of the folder but schema.json; a model replaces the one of its name. All or nothing.
    /// Fails with "FILE: /place: reason".
    Expected<void> load_directory(const std::string& path);
    void add(ServiceModel model);

    /// The model of a service of a board. `friendly_name` is what `#,N` says, empty where it says nothing:
    /// then the letter decides, and of two models with one letter the first by name. Null when no model fits.
    ModelPtr match(char letter, std::string_view friendly_name) const;
    /// By model name; null when unknown.
    ModelPtr find(std::string_view name) const;
    /// By "distance@1"; null when the name or the version differs.
    ModelPtr find_ref(std::string_view ref) const;
    /// True when this very version is built into every program, so that a description may refer to it.
    static bool is_standard(const ServiceModel& model);

    /// Sorted by name.
    const std::vector<ModelPtr>& all() const { return models_; }
    std::vector<std::string> names() const;

  private:
    std::vector<ModelPtr> models_;
};

/// The units of the model that a description refers to ("distance@1"; where this version is unknown, of
/// another one); empty: no such model, or it has none.
std::vector<std::string> units_of(const ModelSet& models, std::string_view reference);

}  // namespace asip::model
