// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace asip::cli {

struct Environment;
class Declaration;

/// What a verb does once its options are read; returns the exit status.
using Run = std::function<int(Environment&)>;

/// A command of asipctl. `commands/NAME.cpp` defines `Verb NAME_verb()`, and one line in cli/CMakeLists.txt
/// lists it; help, manual page and completion follow from what `declare` declares.
struct Verb {
    std::string name;
    std::string summary;  ///< one line of `asipctl help all`
    std::string notes;    ///< below the options in `asipctl NAME --help`: what to know, and examples
    Run (*declare)(Declaration& verb) = nullptr;
    bool uses_bus = true;  ///< it connects to a broker: one is searched where none is configured
};

/// All of them, in the order in which help shows them.
std::vector<Verb> all_verbs();

}  // namespace asip::cli
