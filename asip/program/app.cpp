// SPDX-License-Identifier: Apache-2.0
#include "asip/program/app.hpp"

#include <CLI/CLI.hpp>

namespace asip::program {

Option Option::group(const std::string& name) const {
    return Option(option_->group(name));
}

Option Option::type(const std::string& name) const {
    return Option(option_->type_name(name));
}

Option Option::show_default() const {
    return Option(option_->capture_default_str());
}

Option Option::show_default(const std::string& value) const {
    return Option(option_->default_str(value));
}

Option Option::required() const {
    return Option(option_->required());
}

Option Option::value_optional() const {
    return Option(option_->expected(0, 1));
}

Option Option::repeated() const {
    return Option(
        option_->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll));
}

Option Option::one_value() const {
    return Option(option_->allow_extra_args(false));
}

Option Option::commas() const {
    return Option(option_->delimiter(','));
}

Option Option::environment(const std::string& variable) const {
    return Option(option_->envname(variable));
}

Option Option::words(const std::vector<std::string>& all) const {
    return Option(option_->check(CLI::IsMember(all)));
}

template <class Number>
Option Option::range(Number least, Number greatest) const {
    return Option(option_->check(CLI::Range(least, greatest)));
}

template Option Option::range(int, int) const;
template Option Option::range(unsigned, unsigned) const;
template Option Option::range(unsigned long, unsigned long) const;
template Option Option::range(double, double) const;

Option Option::bytes(std::uint64_t least, std::uint64_t greatest) const {
    return Option(option_->transform(CLI::AsSizeValue(false).description(""))
                      ->check(CLI::Range(least, greatest).description(""))
                      ->type_name("SIZE"));
}

App::App(const std::string& about, const std::string& name) : app_(std::make_shared<CLI::App>(about, name)) {}

void App::footer(const std::string& text) const {
    app_->footer(text);
}

template <class Value>
Option App::add_option(const std::string& name, Value& value, const std::string& help) const {
    return Option(app_->add_option(name, value, help));
}

template Option App::add_option(const std::string&, std::string&, const std::string&) const;
template Option App::add_option(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option App::add_option(const std::string&, std::vector<int>&, const std::string&) const;
template Option App::add_option(const std::string&, int&, const std::string&) const;
template Option App::add_option(const std::string&, unsigned&, const std::string&) const;
template Option App::add_option(const std::string&, unsigned long&, const std::string&) const;
template Option App::add_option(const std::string&, unsigned long long&, const std::string&) const;
template Option App::add_option(const std::string&, double&, const std::string&) const;

Option App::add_flag(const std::string& name, bool& value, const std::string& help) const {
    return Option(app_->add_flag(name, value, help));
}

Option App::option(const std::string& name) const {
    return Option(app_->get_option(name));
}

bool App::given(const std::string& name) const {
    return app_->get_option(name)->count() > 0;
}

App App::add_subcommand(const std::string& name, const std::string& help) const {
    return App(app_->add_subcommand(name, help));
}

void App::fallthrough() const {
    app_->fallthrough();
}

void App::positionals_at_end() const {
    app_->positionals_at_end();
}

bool App::parsed() const {
    return app_->parsed();
}

}  // namespace asip::program
