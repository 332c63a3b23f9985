// SPDX-License-Identifier: Apache-2.0
#include "cli/model/make.hpp"

#include <filesystem>
#include <fstream>
#include <ostream>

#include "asip/model/example_check.hpp"
#include "asip/model/reference_page.hpp"
#include "asip/text/file_text.hpp"
#include "cli/generate/clashes.hpp"
#include "cli/generate/generate.hpp"
#include "cli/generate/layout.hpp"

namespace asip::cli {
namespace {

namespace fs = std::filesystem;
using generate::GeneratedFile;
using model::ServiceModel;

constexpr std::size_t kMaxElements = 100;

std::size_t elements_of(const ModelOptions& options, const ServiceModel& model) {
    return options.elements.value_or(generate::elements_in_examples(model));
}

Outcome<void> write_generated(const fs::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file << text << std::flush;
    if (!file) return failure(program::kExitFailure, path.string() + ": cannot be written");
    return {};
}

/// All or none: nothing is written where a file would be written over that must not.
Outcome<void> write_all(const std::vector<GeneratedFile>& files, const fs::path& folder,
                        const ModelOptions& options, Environment& environment) {
    std::error_code fault;
    fs::create_directories(folder, fault);
    if (fault) return failure(program::kExitFailure, folder.string() + ": " + fault.message());
    if (!options.force) {
        for (const auto& file : files) {
            const auto path = folder / file.name;
            if (!file.own_code && fs::exists(path, fault) && text::file_text(path) != file.text)
                return failure(
                    program::kExitFailure,
                    path.string() + " is there already; --force writes it anew" +
                        (files.size() > 1 ? " (never the file with your code), --into FOLDER elsewhere"
                                          : ""));
        }
    }
    for (const auto& file : files) {
        const auto path = folder / file.name;
        const bool kept = file.own_code && fs::exists(path, fault);
        if (!kept && text::file_text(path) != file.text)
            if (const auto written = write_generated(path, file.text); !written) return written;
        environment.out << path.lexically_normal().string() << (kept ? " (kept as it is)" : "") << '\n';
    }
    environment.out << std::flush;
    return {};
}

Outcome<void> check_model(const ServiceModel& model, const ModelOptions& options, Environment& environment) {
    const auto examples = model::examples(model);
    std::vector<std::string> faults;
    for (const auto& example : examples)
        if (const auto checked = check_example(model, example); !checked) faults.push_back(checked.error());
    const auto wrong_examples = faults.size();
    auto clashes = generate::find_clashes(model, environment.models());
    faults.insert(faults.end(), clashes.faults.begin(), clashes.faults.end());
    environment.out << model.ref() << ", letter " << model.id << ": " << examples.size() - wrong_examples
                    << " of " << examples.size() << " examples are true\n";
    auto notes = missing_examples(model);
    notes.insert(notes.end(), clashes.notes.begin(), clashes.notes.end());
    const auto made = [&](const char* what, const generate::Files& files) {
        if (!files) notes.push_back(std::string("no ") + what + " can be made of it: " + files.error());
    };
    made("firmware", generate::firmware(model, generate::sketch_name(model), elements_of(options, model)));
    made("C++ client", generate::cpp_client(model));
    for (const auto& note : notes)
        environment.out << "note: " << note << '\n';
    environment.out << std::flush;
    if (faults.empty()) return {};
    const auto last = faults.back();
    faults.pop_back();
    for (const auto& fault : faults)
        environment.note(options.files.front() + ": " + fault);
    return failure(program::kExitFailure, options.files.front() + ": " + last);
}

/// A sketch is called as its folder.
Outcome<std::string> name_of_sketch(const fs::path& folder) {
    auto name = fs::absolute(folder / "sketch").parent_path().filename().string();
    constexpr const char* kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
    if (name.empty() || name.size() > 32 || name.find_first_not_of(kAllowed) != std::string::npos)
        return failure(program::kExitUsage,
                       "\"" + name + "\" cannot be the name of a sketch: up to 32 letters, digits and _");
    return name;
}

Outcome<void> make_sketch(const ModelOptions& options, Environment& environment) {
    const fs::path folder = options.output.empty() ? "MyBoard" : options.output;
    const auto name = name_of_sketch(folder);
    if (!name) return Unexpected<Failure>(name.error());
    const auto files = generate::services_sketch(options.files, *name);
    if (!files) return failure(program::kExitUsage, files.error());
    return write_all(*files, folder, options, environment);
}

Outcome<void> make_firmware(const ServiceModel& model, const ModelOptions& options,
                            Environment& environment) {
    const fs::path folder = options.output.empty() ? generate::sketch_name(model) : options.output;
    const auto name = name_of_sketch(folder);
    if (!name) return Unexpected<Failure>(name.error());
    const auto files = generate::firmware(model, *name, elements_of(options, model));
    if (!files) return failure(program::kExitFailure, options.files.front() + ": " + files.error());
    return write_all(*files, folder, options, environment);
}

Outcome<void> make_part(const ServiceModel& model, const ModelOptions& options, Environment& environment) {
    const auto image = options.image.empty() ? generate::sketch_name(model) + ".elf"
                                             : fs::absolute(options.image).lexically_normal().string();
    auto files = generate::simulated_part(model, image, elements_of(options, model));
    if (!files) return failure(program::kExitFailure, options.files.front() + ": " + files.error());
    const fs::path output(options.output);
    if (!options.output.empty()) files->front().name = output.filename().string();
    return write_all(*files, options.output.empty() || !output.has_parent_path() ? "." : output.parent_path(),
                     options, environment);
}

Outcome<void> make_client(const ServiceModel& model, const ModelOptions& options, Environment& environment) {
    const auto files = generate::cpp_client(model);
    if (!files) return failure(program::kExitFailure, options.files.front() + ": " + files.error());
    return write_all(*files, options.output.empty() ? "." : options.output, options, environment);
}

Outcome<void> make_docs(const ServiceModel& model, const ModelOptions& options, Environment& environment) {
    const auto page = model::reference_page(model);
    if (options.output.empty()) {
        environment.out << page << std::flush;
        return {};
    }
    const fs::path output(options.output);
    return write_all({{output.filename().string(), page}},
                     output.has_parent_path() ? output.parent_path() : fs::path("."), options, environment);
}

}  // namespace

int make_of_model(const ModelOptions& options, Environment& environment) {
    if (options.elements && (*options.elements < 1 || *options.elements > kMaxElements))
        return environment.fail_with({program::kExitUsage, "--elements: a number from 1 to 100"});
    if (options.action == "sketch") {
        const auto made = make_sketch(options, environment);
        return made ? program::kExitOk : environment.fail_with(made.error());
    }
    const auto model = model::load_service_model(options.files.front());
    if (!model) return environment.fail_with({program::kExitFailure, model.error()});
    const auto action = options.action == "check"      ? check_model
                        : options.action == "firmware" ? make_firmware
                        : options.action == "part"     ? make_part
                        : options.action == "docs"     ? make_docs
                                                       : make_client;
    const auto done = action(*model, options, environment);
    return done ? program::kExitOk : environment.fail_with(done.error());
}

}  // namespace asip::cli
