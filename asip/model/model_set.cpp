// SPDX-License-Identifier: Apache-2.0
#include "asip/model/model_set.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "asip/model/embedded.hpp"
#include "asip/text/file_text.hpp"

namespace asip::model {
namespace {

namespace fs = std::filesystem;

ModelSet load_standard() {
    ModelSet set;
    for (const auto& [name, text] : embedded_models()) {
        auto model = parse_service_model(text);
        if (!model) throw std::logic_error("built-in model " + std::string(name) + ": " + model.error());
        set.add(std::move(*model));
    }
    return set;
}

}  // namespace

const ModelSet& ModelSet::standard() {
    static const ModelSet set = load_standard();
    return set;
}

Expected<ModelSet> ModelSet::standard_and(const std::string& folder) {
    auto models = standard();
    if (folder.empty()) return models;
    if (auto loaded = models.load_directory(folder); !loaded) return fail(loaded.error());
    return models;
}

void ModelSet::add(ServiceModel model) {
    auto shared = std::make_shared<const ServiceModel>(std::move(model));
    const auto place =
        std::lower_bound(models_.begin(), models_.end(), shared,
                         [](const ModelPtr& a, const ModelPtr& b) { return a->name < b->name; });
    if (place != models_.end() && (*place)->name == shared->name)
        *place = std::move(shared);
    else
        models_.insert(place, std::move(shared));
}

Expected<void> ModelSet::load_directory(const std::string& path) {
    std::error_code fault;
    std::vector<fs::path> files;
    for (fs::directory_iterator it(path, fault), end; !fault && it != end; it.increment(fault)) {
        const auto& file = it->path();
        if (file.extension() == ".json" && file.filename() != "schema.json") files.push_back(file);
    }
    if (fault) return fail(path + ": " + fault.message());
    std::sort(files.begin(), files.end());
    ModelSet extended = *this;
    for (const auto& file : files) {
        auto model = load_service_model(file.string());
        if (!model) return fail(model.error());
        extended.add(std::move(*model));
    }
    *this = std::move(extended);
    return {};
}

ModelPtr ModelSet::match(char letter, std::string_view friendly_name) const {
    const auto found = std::find_if(models_.begin(), models_.end(), [&](const ModelPtr& model) {
        return model->matches(letter, friendly_name);
    });
    return found == models_.end() ? nullptr : *found;
}

ModelPtr ModelSet::find(std::string_view name) const {
    const auto found = std::find_if(models_.begin(), models_.end(),
                                    [&](const ModelPtr& model) { return model->name == name; });
    return found == models_.end() ? nullptr : *found;
}

ModelPtr ModelSet::find_ref(std::string_view ref) const {
    auto model = find(ref.substr(0, ref.find('@')));
    return model && model->ref() == ref ? model : nullptr;
}

bool ModelSet::is_standard(const ServiceModel& model) {
    const auto built_in = standard().find(model.name);
    return built_in && built_in->source == model.source;
}

std::vector<std::string> ModelSet::names() const {
    std::vector<std::string> result;
    for (const auto& model : models_)
        result.push_back(model->name);
    return result;
}

Expected<ServiceModel> load_service_model(const std::string& path) {
    constexpr std::uintmax_t kMaxFileBytes = std::size_t{64} * 1024;
    std::error_code fault;
    const auto size = fs::file_size(path, fault);
    if (fault) return fail(path + ": " + fault.message());
    if (size > kMaxFileBytes) return fail(path + ": is larger than 64 KiB");
    const auto text = text::file_text(path);
    if (!text) return fail(path + ": " + text.error());
    auto model = parse_service_model(*text);
    if (!model) return fail(path + ": " + model.error());
    return model;
}

std::vector<std::string> units_of(const ModelSet& models, std::string_view reference) {
    auto model = models.find_ref(reference);
    if (!model) model = models.find(reference.substr(0, reference.find('@')));
    return model ? units_of(*model) : std::vector<std::string>{};
}

}  // namespace asip::model
