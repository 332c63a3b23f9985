// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "asip/expected.hpp"
#include "sim/wiring/part_kind.hpp"

namespace asip::sim {

/// On a board's pins. Used only between the board's runs (or in its callbacks).
class Part {
  public:
    virtual ~Part() = default;
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    const std::string& name() const { return name_; }
    const PartKind& kind() const { return kind_; }

    /// "on", "pressed", "0.5", "90".
    virtual std::string state() const = 0;

    /// "press", "release", "set" with "0.25". Errors: no such verb (with those there are), an argument too
    /// many, or out of range.
    Expected<void> command(std::string_view verb, std::string_view argument);

    /// Restart what runs by time; levels are driven already.
    virtual void after_reset() {}

  protected:
    Part(std::string name, const PartKind& kind) : name_(std::move(name)), kind_(kind) {}

  private:
    /// `verb` is one of the kind's; `argument` may be empty.
    virtual Expected<void> perform(std::string_view verb, std::string_view argument);

    std::string name_;
    const PartKind& kind_;
};

}  // namespace asip::sim
