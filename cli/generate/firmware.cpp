// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <nlohmann/json.hpp>

#include "cli/generate/firmware_model.hpp"
#include "cli/generate/generate.hpp"
#include "cli/generate/names.hpp"
#include "cli/generate/render.hpp"
#include "cli/generate/sketch_view.hpp"

namespace asip::generate {
namespace {

using model::ServiceModel;

constexpr std::size_t kLongestAnnounced = 24;

}  // namespace

std::string sketch_name(const ServiceModel& model) {
    return pascal_case(model.name);
}

std::string announced_name(const ServiceModel& model) {
    for (const auto& word : model.match) {
        std::string plain;
        for (const char c : word) {
            const bool keeps =
                std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' || c == '_';
            if (keeps)
                plain += c;
            else if (!plain.empty() && plain.back() != ' ')
                plain += ' ';
        }
        while (plain.ends_with(' '))
            plain.pop_back();
        if (!plain.empty() && plain.size() <= kLongestAnnounced && model.matches(model.id, plain))
            return plain;
    }
    return model.name;
}

Files firmware(const ServiceModel& model, const std::string& sketch, std::size_t elements) {
    if (auto fault = firmware_fault(model); !fault.empty()) return fail(std::move(fault));
    const auto made = sketch_view(model, sketch, elements);
    if (!made) return fail(made.error());
    const auto& view = *made;
    const auto class_name = view["class"].get<std::string>();
    return std::vector<GeneratedFile>{
        {sketch + ".ino", render(template_text("sketch.ino"), view)},
        {class_name + ".h", render(template_text("service.h"), view)},
        {class_name + ".cpp", render(template_text("service.cpp"), view)},
        {pascal_case(model.name) + "Hardware.cpp", render(template_text("hardware.cpp"), view), true}};
}

}  // namespace asip::generate
