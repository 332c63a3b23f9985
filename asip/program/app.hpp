// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace asip::program {

/// An option or argument of an App. Each function returns the option itself.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}
    CLI::Option* get() const { return option_; }

    /// Below which headline --help shows it.
    Option group(const std::string& name) const;
    /// What --help calls its value.
    Option type(const std::string& name) const;
    /// --help shows the value that the variable has now; or this one.
    Option show_default() const;
    Option show_default(const std::string& value) const;

    Option required() const;
    /// It may stand without a value.
    Option value_optional() const;
    /// Each time with one value.
    Option repeated() const;
    /// What stands behind its value is no value of it.
    Option one_value() const;
    /// Several values with commas between them.
    Option commas() const;
    /// Where the command line has none.
    Option environment(const std::string& variable) const;

    /// Others are refused.
    Option words(const std::vector<std::string>& all) const;
    /// Bounds are included.
    template <class Number>
    Option range(Number least, Number greatest) const;
    /// `512k`, `256M`, `2G`.
    Option bytes(std::uint64_t least, std::uint64_t greatest) const;

  private:
    CLI::Option* option_;
};

/// The command line of a program, or of a subcommand: CLI11, whose headers cost the compiler seconds in each
/// source that includes them. Values are written when Settings parses it.
class App {
  public:
    explicit App(const std::string& about, const std::string& name = {});
    CLI::App& cli() const { return *app_; }

    void footer(const std::string& text) const;
    /// `name`: `--long`, `-s,--long`, or the name of an argument. For strings, numbers, and lists of strings
    /// and of int.
    template <class Value>
    Option add_option(const std::string& name, Value& value, const std::string& help) const;
    Option add_flag(const std::string& name, bool& value, const std::string& help) const;
    /// One that was added.
    Option option(const std::string& name) const;
    /// The option stands on the command line.
    bool given(const std::string& name) const;

    App add_subcommand(const std::string& name, const std::string& help) const;
    /// Options of the program may stand behind a subcommand.
    void fallthrough() const;
    /// All that follows the first argument is one, too.
    void positionals_at_end() const;
    /// A subcommand was given.
    bool parsed() const;

  private:
    explicit App(CLI::App* subcommand) : app_(subcommand, [](CLI::App*) {}) {}

    std::shared_ptr<CLI::App> app_;
};

}  // namespace asip::program
