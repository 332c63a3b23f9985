// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asip/expected.hpp"

namespace asip::cli {

/// Options of every command with their values, without the `--`.
using OptionValues = std::vector<std::pair<std::string, std::string>>;

/// A bus with a name, by `asipctl context add`.
struct Profile {
    std::string name;
    OptionValues options;

    /// Empty: the option is not there.
    std::string value(const std::string& option) const;
};

/// The named buses of a user, in files that only the user may read, and the current one.
class Profiles {
  public:
    using Variables = std::function<std::optional<std::string>(const std::string&)>;

    explicit Profiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
    /// In `$XDG_CONFIG_HOME/asip`, else `~/.config/asip`; nothing: there is neither.
    static std::optional<Profiles> of_user(const Variables& variables);

    std::vector<std::string> names() const;
    /// Fails, with the nearest, where there is none, or it cannot be read.
    Expected<Profile> find(const std::string& name) const;
    Expected<void> add(const Profile& bus);
    Expected<void> remove(const std::string& name);

    /// Empty: none.
    std::string current() const;
    /// Empty: none from now on.
    Expected<void> use(const std::string& name);

  private:
    std::filesystem::path file_of(const std::string& name) const {
        return folder_ / "contexts" / (name + ".conf");
    }
    std::filesystem::path current_file() const { return folder_ / "context"; }

    std::filesystem::path folder_;
};

/// Puts the options of the named bus in front: that of `--context`, else of ASIP_CONTEXT, else the current
/// one. A user who names a broker, credentials or a configuration file otherwise uses none of it: a password
/// goes to no other broker. Fails on an unknown bus.
Expected<std::vector<std::string>> with_profile(std::vector<std::string> arguments,
                                                const Profiles::Variables& variables);

}  // namespace asip::cli
