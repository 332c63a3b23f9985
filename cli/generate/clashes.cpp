// SPDX-License-Identifier: Apache-2.0
#include "cli/generate/clashes.hpp"

#include <fmt/format.h>

#include "cli/generate/generate.hpp"

namespace asip::generate {

Clashes find_clashes(const model::ServiceModel& model, const model::ModelSet& known) {
    Clashes clashes;
    std::vector<std::string> same_letter;
    const auto announced = announced_name(model);
    for (const auto& other : known.all()) {
        if (other->source == model.source) continue;
        if (other->name == model.name)
            clashes.notes.push_back(
                fmt::format("replaces the model {} that programs have built in; for another kind of service "
                            "choose another name",
                            other->ref()));
        if (other->id != model.id || other->name == model.name) continue;
        if (other->matches(model.id, announced))
            clashes.faults.push_back(
                fmt::format("/match: a board that calls it \"{}\" is taken for {}, which has the letter {}, "
                            "too; use other words or another letter",
                            announced, other->name, model.id));
        else
            same_letter.push_back(other->name);
    }
    if (model.id == 'I' && model.name != "io")
        clashes.faults.push_back("/id: I is the letter of the pins of each board; use another");
    if (!same_letter.empty())
        clashes.notes.push_back(fmt::format("letter {} is also that of {}: one board cannot have both",
                                            model.id, fmt::join(same_letter, ", ")));
    if (model.match.empty())
        clashes.notes.push_back(fmt::format("has no \"match\": boards must call it {}", model.name));
    return clashes;
}

}  // namespace asip::generate
